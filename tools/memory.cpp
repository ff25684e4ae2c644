#include "tools/memory.h"

#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <fstream>

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

double resident_bytes() {
  double total = 0.0, resident = 0.0;  // pages
  std::ifstream statm("/proc/self/statm");
  return statm >> total >> resident ? resident * double(sysconf(_SC_PAGESIZE)) : std::nan("");
}

}  // namespace lodestone
