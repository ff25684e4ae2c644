// How much of the heap the process uses.
#pragma once

namespace lodestone {

/// Bytes handed out by malloc and not yet given back (glibc); NaN with another C library.
double heap_bytes();

}  // namespace lodestone
