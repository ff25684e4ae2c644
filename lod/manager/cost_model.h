// What a body costs in a step, on the rung that it has and on those that it might have. Counted work is fixed: a microsecond of the machine that it was measured on,
// so that it repeats exactly. Milliseconds are the work times a factor that is learnt, rung by rung, from measured steps.
#pragma once

#include <array>
#include <cstdint>

#include "lod/manager/choose_levels.h"
#include "lod/rungs/statistical_level.h"
#include "lod/step_report.h"

namespace lodestone {

/// Bodies by rung and by what they do, and changes to each rung.
struct StepCounts {
  std::array<std::array<int, kActivities>, kRungs> bodies{};
  std::array<int, kRungs> changes{};
  int asked = 0;  ///< bodies that the policy was asked about

  int& at(Rung rung, Activity activity) { return bodies[std::size_t(rung)][std::size_t(activity)]; }
  int at(Rung rung, Activity activity) const { return bodies[std::size_t(rung)][std::size_t(activity)]; }
};

/// Processor time of a step, ms.
struct StepMeasurement {
  std::array<double, kRungs> rungs_ms{};
  double others_ms = 0.0;  ///< choice, transfer, contacts between levels, report
  double total_of_rungs_ms() const { return rungs_ms[0] + rungs_ms[1] + rungs_ms[2]; }
  double total_ms() const { return total_of_rungs_ms() + others_ms; }
};

class CostModel {
 public:
  /// In milliseconds as they were learnt, or in work units.
  enum class Unit : std::uint8_t { work, milliseconds };
  void set_unit(Unit unit) { unit_ = unit; }

  /// Of one more body that does this, at each rung, by what is full at present. One that touches nothing is charged for the crowd that it may be in soon, too.
  std::array<float, kRungs> cost_of(Activity activity) const;
  /// Besides the bodies.
  StepOverhead overhead(const StepCounts& counts) const;
  /// Predicted for all the bodies of `counts`: fills predicted_ms and work.
  void predict(const StepCounts& counts, StepReport& report) const;
  /// From a step in which the bodies did what `counts` says.
  void learn(const StepCounts& counts, const StepMeasurement& measured);
  /// Full bodies that touch others, of which a heap is made, and those that are awake, of which one may be.
  void set_heap(int touching, int awake) { heap_ = touching, awake_ = awake; }

  double margin() const { return margin_; }

 private:
  double factor(Rung rung, Activity activity) const;
  double ms_of(const StepCounts& counts, Rung rung) const;

  Unit unit_ = Unit::work;
  std::array<std::array<double, kActivities>, kRungs> factors_{{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}};
  double others_factor_ = 1.0;
  std::array<double, kRungs> spread_{0.2, 0.2, 2.0};  // over what a rung is predicted to cost
  std::array<double, kRungs> arrival_ms_{};             // of one change to a rung, in the step in which it is made
  double margin_ = 0.1;  // over all that
  int heap_ = 0, awake_ = 0;
};

/// Work units, µs, of a body on a rung, where `heap` full bodies touch others.
double work_of(Rung rung, Activity activity, int heap);

}  // namespace lodestone
