#include "scenes/run_observer.h"

#include <algorithm>

namespace lodestone {

void RunObserver::begin(const Manager& manager, std::span<const BodyId> bodies) {
  read(manager, bodies);
  energy_start_j_ = energy_max_j_ = sample_.energy_j;
  max_tables_penetration_m_ = max_other_penetration_m_ = 0;
}

void RunObserver::begin_from(const RunObserver& other, const Manager& manager,
                             std::span<const BodyId> bodies) {
  sample_ = other.sample_, last_awake_s_ = other.last_awake_s_;
  read(manager, bodies);
  energy_start_j_ = energy_max_j_ = sample_.energy_j;
}

void RunObserver::look(const Manager& manager, std::span<const BodyId> bodies, int step) {
  if (manager.report().asleep < int(bodies.size())) last_awake_s_ = (step + 1) * dt_s_;
  read(manager, bodies);
  look_at_picture(step);
}

void RunObserver::read(const Manager& manager, std::span<const BodyId> bodies) {
  read_sample(manager, bodies, scene_, sample_);
  is_finite_ = is_finite_ && sample_.finite;
  energy_max_j_ = std::max(energy_max_j_, sample_.energy_j);
  max_tables_penetration_m_ = std::max(max_tables_penetration_m_, sample_.max_tables_penetration_m);
  max_other_penetration_m_ = std::max(max_other_penetration_m_, sample_.max_other_penetration_m);
}

/// Of the first viewpoint, from where the step that ended was given it.
void RunObserver::look_at_picture(int step) {
  constexpr double kFrom = 0.5;  // s
  if (scene_.viewpoints.empty() || (step + 1) * dt_s_ < kFrom) return;
  const SceneViewpoint& viewpoint = scene_.viewpoints.front();
  const int full =
      count_full_in_picture(sample_, Camera(viewpoint.position_at(step * dt_s_), viewpoint.look_at_m));
  if (!in_picture_) in_picture_ = PictureFigures{.min_full = full};
  in_picture_->min_full = std::min(in_picture_->min_full, full);
  in_picture_->mean_full += (full - in_picture_->mean_full) / ++pictures_;
}

double RunObserver::mean_distance_m(const RunObserver& other) const {
  double sum = 0;
  for (std::size_t i = 0; i < sample_.states.size(); ++i)
    sum += (sample_.states[i].position - other.sample_.states[i].position).norm();
  return sample_.states.empty() ? 0.0 : sum / double(sample_.states.size());
}

void RunObserver::sum_up(RunResult& result, int end_step) const {
  result.finite = is_finite_;
  result.states = sample_.states;
  result.in_picture = in_picture_;
  result.energy_start_j = energy_start_j_, result.energy_max_j = energy_max_j_;
  result.energy_end_j = sample_.energy_j;
  result.max_tables_penetration_m = max_tables_penetration_m_;
  result.max_penetration_m = std::max(max_tables_penetration_m_, max_other_penetration_m_);
  result.checks = depth_checks(result.max_penetration_m);
  if (const auto bound_s = scene_.checks.all_asleep_by_s)
    result.checks.push_back(asleep_check(*bound_s, end_step));
}

std::vector<CheckResult> RunObserver::depth_checks(double deepest_m) const {
  std::vector<CheckResult> checks;
  const auto add = [&](const char* name, double value, std::optional<double> bound) {
    if (bound) checks.push_back({name, value, *bound, value <= *bound});
  };
  const std::optional<double> of_tables = scene_.checks.max_tables_penetration_m;
  add("max_penetration_m", of_tables ? max_other_penetration_m_ : deepest_m, scene_.checks.max_penetration_m);
  add("max_tables_penetration_m", max_tables_penetration_m_, of_tables);
  return checks;
}

/// Its value is when somebody was last awake: who is so at the bound or after it fails it, even where he
/// slept before.
CheckResult RunObserver::asleep_check(double bound_s, int end_step) const {
  constexpr double kRounding = 1e-9;  // s, of times that are sums of steps
  const double end_s = end_step * dt_s_;
  const bool all_asleep = last_awake_s_ < end_s,
             in_time = last_awake_s_ < std::max(bound_s, dt_s_) - kRounding;
  return {"all_asleep_by_s", last_awake_s_, bound_s, in_time, all_asleep || end_s >= bound_s - kRounding};
}

}  // namespace lodestone
