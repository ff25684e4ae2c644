// What a scene costs in which everything sleeps, and what a body that falls into it wakes.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "lod/body.h"
#include "signature/signature_source.h"

namespace lodestone {

struct SettledSettings {
  int bodies = 1'000'000;
  std::vector<StatisticalModel> models = {StatisticalModel::tables, StatisticalModel::support};
  int threads = 1;
  int steps = 200;      ///< of 1/60 s, timed in each state of the scene
  double speed = 10.0;  ///< m/s, at which one more body falls among the others
  std::uint64_t seed = 1;
  Progress progress = {};
};

/// Crates at rest on a plane, half a metre apart; the levels are the distance policy's, with viewpoints too
/// far away for any to be full.
struct SettledRow {
  StatisticalModel model = StatisticalModel::tables;
  int bodies = 0, threads = 1;
  int settling_steps = 0;         ///< until all sleep
  int awake = 0;                  ///< then
  double bytes_per_body = 0.0;    ///< of the heap, then
  double settled_us = 0.0;        ///< median step: without viewpoints
  double watched_us = 0.0;        ///< with one that stands still
  double moving_us = 0.0;         ///< with one that moves .1 m in a step
  int woken = 0;                  ///< the most that were awake in a step after a body fell in, itself counted
  double farthest_woken_m = 0.0;  ///< from where it fell
  int woken_unseen = 0;           ///< bodies that woke farther away than that: none
  int disturbed_steps = 0;        ///< until all sleep again; at most `steps`
  double disturbed_us = 0.0, disturbed_most_us = 0.0;  ///< median and longest of these steps
};

/// Coarse, where nothing depends on how a body bounces.
std::shared_ptr<const Signature> make_coarse_signature(const Shape& shape);

std::vector<SettledRow> bench_settled(const SettledSettings& settings);

}  // namespace lodestone
