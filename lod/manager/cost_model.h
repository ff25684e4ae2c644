// What bodies cost in a step, on the rungs that they have and on those that they might have. Counted work is
// fixed: a microsecond of the machine that it was measured on, so that it repeats exactly. Milliseconds are
// the work times factors that are learnt from measured steps, one for each line of a rung's bill.
#pragma once

#include <array>
#include <cstdint>

#include "lod/manager/choose_levels.h"
#include "lod/rungs/statistical_level.h"
#include "lod/step_report.h"
#include "reference/state_archive.h"

namespace lodestone {

/// What a rung is charged for in a step: bodies asleep, alone and in a crowd, as Activity has them; those of
/// the crowd that came to it or woke lately, besides; and what full bodies do there: at the full level the
/// pairs that they make (full_pairs.h), at `support` their contacts with statistical bodies, one for each
/// that touches any; at the full level those awake that joints hold, which are neither alone nor in a crowd.
inline constexpr std::size_t kArriving = kActivities, kOfFull = kActivities + 1, kJoined = kActivities + 2,
                             kCharges = kActivities + 3;
using Charges = std::array<double, kCharges>;

/// Steps after a change of rung or a waking, in which a body in a crowd counts as arriving.
inline constexpr int kArrivalSteps = 16;

struct StepCounts {
  std::array<Charges, kRungs> rungs{};
  std::array<int, kRungs> changes{};  ///< made in this step, to each rung
  int added = 0;                      ///< bodies that take their first rung
  int asked = 0;                      ///< bodies that the policy was asked about

  double& at(Rung rung, Activity activity) { return rungs[std::size_t(rung)][std::size_t(activity)]; }
  double at(Rung rung, Activity activity) const { return rungs[std::size_t(rung)][std::size_t(activity)]; }
  void archive(StateArchive& a) { a(rungs, changes, added, asked); }
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

  /// What a body of this mesh (full_pairs.h) is charged at the full level, of what one of 4,698 faces is: in
  /// work units the same.
  double full_share(float mesh_weight) const;
  /// Of one more body that does this, at each rung, but for the pairs that it makes there. One that touches
  /// nothing is charged for the crowd that it may be in soon, too. `share`: see full_share.
  std::array<float, kRungs> cost_of(Activity activity, double share = 1.0) const;
  /// Of one that must be full, so that nothing is gained by a reserve for what it may come to do; `held`:
  /// awake, by joints.
  double cost_of_forced_full(Activity activity, bool held, double share) const;
  /// Besides, of one that came to the rung lately and is in a crowd.
  double cost_of_arriving(Rung rung) const { return price(rung, kArriving); }
  /// Besides the bodies.
  StepOverhead overhead(const StepCounts& counts) const;
  /// Predicted for all that `counts` has: fills predicted_ms and work.
  void predict(const StepCounts& counts, StepReport& report) const;
  /// From a step that was predicted to take so many ms of its budget, and in which the bodies did what
  /// `counts` says.
  void learn(double budget_ms, double predicted_ms, const StepCounts& counts,
             const StepMeasurement& measured);

  /// Of one body, whatever the unit.
  double ms_of_one(Rung rung, std::size_t charge) const;
  double margin() const { return margin_; }
  void archive(StateArchive& a) { a(unit_, factors_, last_error_, others_factor_, changes_factor_, margin_); }

 private:
  double price(Rung rung, std::size_t charge) const;
  double ms_of(const StepCounts& counts, Rung rung) const;
  double others_ms(const StepCounts& counts) const;
  double changes_ms(const StepCounts& counts) const;
  void learn_rung(std::size_t rung, const Charges& charges, double measured_ms);

  Unit unit_ = Unit::work;
  std::array<Charges, kRungs> factors_{{{1, 1, 1, 1, 1, 1}, {1, 1, 1, 1, 1, 1}, {1, 1, 1, 1, 1, 1}}};
  std::array<double, kRungs> last_error_{};  // of a rung's prediction, as a part of it
  double others_factor_ = 1.0, changes_factor_ = 1.0;
  double margin_ = 0.2;  // by which a step may exceed its prediction, as a part of it
};

/// Work units, µs, of one on a rung.
double work_of(Rung rung, std::size_t charge);

}  // namespace lodestone
