// What it costs to add and remove bodies all the time, as level streaming does: in a world of many, each of a
// mass of its own.
#pragma once

#include <vector>

#include "lod/body.h"
#include "signature/signature_source.h"

namespace lodestone {

struct ChurnSettings {
  int bodies = 10'000;
  int full_bodies = 1'000;  ///< in place of them at the full level, of which ODE steps each
  int per_second = 10'000;  ///< bodies added, and as many removed
  int frames = 120;         ///< of 1/60 s
  int threads = 1;
  std::uint64_t seed = 1;
  Progress progress = {};
};

/// Crates two metres apart: all in flight, or asleep on a plane. A frame's bodies are removed, others added,
/// which are awake, and a step taken; where bodies sleep, so do these before the next frame.
struct ChurnRow {
  Rung rung = Rung::support;
  bool asleep = false;
  int bodies = 0;
  int churned = 0;                             ///< in a frame, removed and added each
  double first_step_ms = 0.0;                  ///< with all bodies new
  double removal_us = 0.0, addition_us = 0.0;  ///< medians, of a body
  double step_ms = 0.0;                        ///< median, before bodies come and go
  double churned_step_ms = 0.0;                ///< median, while they do
  /// Milliseconds that coming and going takes in a frame: the calls, and what the step is longer by.
  double frame_ms() const { return 1e-3 * churned * (removal_us + addition_us) + churned_step_ms - step_ms; }
};

std::vector<ChurnRow> bench_churn(const ChurnSettings& settings);

}  // namespace lodestone
