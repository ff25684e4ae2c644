// What the full level costs: bodies that fall on a plane in one world, too far apart to touch, by each way of
// finding their contacts with it.
#pragma once

#include <string>
#include <vector>

#include "tools/methods/method.h"

namespace lodestone {

struct FullLevelBenchSettings {
  int bodies = 100;
  int steps = 30;   ///< of 1/60 s, begun in the air: all have landed; nobody sleeps
  int repeats = 3;  ///< of the whole, methods taking turns
  std::vector<std::string> methods = {"full_plain", "full_1", "full"};  ///< of compare drop, ODE's only
  std::uint64_t seed = 1;
  Progress progress;
};

struct FullLevelBenchRow {
  std::string method;
  int substeps = 1;
  double falling_ms = 0.0;  ///< median step before any body can have reached the plane
  double step_ms = 0.0;     ///< median of all steps
  double times_less = 1.0;  ///< the first method's step_ms over this one's
  std::string left_out = {};
};

std::vector<FullLevelBenchRow> bench_full_level(const DropJob& job, const FullLevelBenchSettings& settings);

}  // namespace lodestone
