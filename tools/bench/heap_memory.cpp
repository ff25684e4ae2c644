#include "tools/bench/heap_memory.h"

#include <cmath>
#include <cstdlib>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace lodestone {

double heap_bytes() {
#ifdef __GLIBC__
  const auto info = mallinfo2();
  return double(info.uordblks) + double(info.hblkhd);
#else
  return std::nan("");
#endif
}

}  // namespace lodestone
