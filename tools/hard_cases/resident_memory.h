// How much memory the process holds.
#pragma once

namespace lodestone {

/// Bytes resident now (Linux: /proc/self/statm); NaN where that cannot be read.
double resident_bytes();

}  // namespace lodestone
