// What a run shows of its bodies: energy, depth in the ground, who is in the picture, and how long they are
// awake. Read after each step, outside of its time.
#pragma once

#include <optional>
#include <span>

#include "scenes/run_result.h"
#include "scenes/run_sample.h"
#include "scenes/scene.h"

namespace lodestone {

class RunObserver {
 public:
  /// `scene` outlives it; steps of `dt_s`.
  RunObserver(const Scene& scene, double dt_s) : scene_(scene), dt_s_(dt_s) {}

  /// The bodies as the scene sets them up: how deep they are is no matter of the run's.
  void begin(const Manager& manager, std::span<const BodyId> bodies);
  /// As `other` saw them last.
  void begin_from(const RunObserver& other, const Manager& manager, std::span<const BodyId> bodies);
  /// After `step`, counted from 0.
  void look(const Manager& manager, std::span<const BodyId> bodies, int step);

  const RunSample& sample() const { return sample_; }
  bool is_finite() const { return is_finite_; }  ///< no NaN or infinity so far
  /// Of the bodies here from those there, m, mean.
  double mean_distance_m(const RunObserver& other) const;

  /// Energies, depths, the picture, states and the scene's checks; `end_step`: how many steps there were from
  /// the scene's start on.
  void sum_up(RunResult& result, int end_step) const;

 private:
  void read(const Manager& manager, std::span<const BodyId> bodies);
  void look_at_picture(int step);
  std::vector<CheckResult> depth_checks(double deepest_m) const;
  CheckResult asleep_check(double bound_s, int end_step) const;

  const Scene& scene_;
  double dt_s_;
  RunSample sample_;
  bool is_finite_ = true;
  double energy_start_j_ = 0, energy_max_j_ = 0;
  double max_tables_penetration_m_ = 0, max_other_penetration_m_ = 0;
  std::optional<PictureFigures> in_picture_;
  int pictures_ = 0;
  double last_awake_s_ = 0;  // when somebody was, after a step
};

}  // namespace lodestone
