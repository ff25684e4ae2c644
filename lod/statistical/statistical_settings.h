// How the statistical bodies of a world are simulated.
#pragma once

#include "lod/jobs.h"
#include "lod/simd/wide_loop.h"
#include "lod/tables_options.h"
#include "reference/geometry.h"

namespace lodestone {

struct StatisticalSettings {
  Vec3 gravity{0, 0, -9.81};  ///< m/s²
  std::uint64_t seed = 1;
  int threads = 1;
  JobRunner jobs = {};        ///< empty: oneTBB's on so many threads
  TablesOptions tables = {};
  bool sleeping = true;
  Simd simd = find_simd();    ///< the results do not depend on it
};

}  // namespace lodestone
