// How many threads oneTBB may run.
#pragma once

#include <tbb/global_control.h>

#include <algorithm>
#include <cstddef>

namespace lodestone {

/// As many as are asked for, but no more than it runs in this process (the cores, unless somebody has set a
/// limit): an arena of more would only make it write a warning to stderr, "The number of workers is currently
/// limited". `asked` ≤ 0: all of them.
inline int allowed_threads(int asked) {
  const int most = int(std::min<std::size_t>(
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism), 1 << 16));
  return asked > 0 ? std::min(asked, most) : most;
}

}  // namespace lodestone
