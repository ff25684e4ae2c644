// What is done to a manager, written down as it happens, and done again to see where it first comes out
// otherwise.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "lod/body.h"

namespace lodestone {

/// Is given bytes to append to a recording. It must not change the manager.
using RecordFunction = std::function<void(std::span<const std::byte>)>;

struct ReplayResult {
  int steps = 0;     ///< that were done again, up to the first that came out otherwise
  bool same = true;  ///< all did as recorded
  /// Where not: the first body, in order of creation, that is otherwise after that step; null where one is
  /// missing.
  BodyId body = {};
  std::string text = {};  ///< the same in words
};

}  // namespace lodestone
