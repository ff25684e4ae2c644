// How much memory the process uses.
#pragma once

namespace lodestone {

/// Bytes handed out by malloc and not yet given back (glibc); NaN with another C library.
double heap_bytes();

/// Bytes resident now (Linux: /proc/self/statm); NaN where that cannot be read.
double resident_bytes();

}  // namespace lodestone
