#include "tools/hard_cases/resident_memory.h"

#include <unistd.h>

#include <cmath>
#include <fstream>

namespace lodestone {

double resident_bytes() {
  double total = 0.0, resident = 0.0;  // pages
  std::ifstream statm("/proc/self/statm");
  return statm >> total >> resident ? resident * double(sysconf(_SC_PAGESIZE)) : std::nan("");
}

}  // namespace lodestone
