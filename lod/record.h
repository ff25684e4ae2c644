// Recordings: what is done to a manager is written down as it happens; a replay does it again, and finds the
// first step that comes out differently.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "lod/body.h"

namespace lodestone {

/// Called with the next bytes of a recording, to be appended to those before. It must not change the manager.
using RecordFunction = std::function<void(std::span<const std::byte>)>;

/// What Manager::replay found.
struct ReplayResult {
  int steps = 0;     ///< steps repeated, including the first that came out differently
  bool same = true;  ///< whether all came out as recorded
  /// If not: the first body, in order of creation, whose state differs after that step; null if only the
  /// number of bodies differs.
  BodyId body = {};
  std::string text = {};  ///< the result in words
};

}  // namespace lodestone
