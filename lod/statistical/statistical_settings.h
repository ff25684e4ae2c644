// How the statistical bodies of a world are simulated.
#pragma once

#include <functional>

#include "lod/body.h"
#include "lod/jobs.h"
#include "lod/simd/wide_loop.h"
#include "lod/statistical/own_properties.h"
#include "lod/tables_options.h"
#include "reference/geometry.h"

namespace lodestone {

struct StatisticalSettings {
  Vec3 gravity{0, 0, -9.81};  ///< m/s²
  std::uint64_t seed = 1;
  int threads = 1;
  JobRunner jobs = {};  ///< empty: oneTBB's on so many threads
  TablesOptions tables = {};
  bool sleeping = true;
  SleepThresholds sleep = {};
  /// Of bodies at `support` and of full ones, by owner; those at `tables` have none. Null: nobody has any.
  /// Must outlive the level.
  const OwnProperties* properties = nullptr;
  /// Of two owners: whether they may meet; empty: all do. Called from several threads.
  std::function<bool(std::uint32_t, std::uint32_t)> pair_filter = {};
  Simd simd = find_simd();  ///< the results do not depend on it
};

}  // namespace lodestone
