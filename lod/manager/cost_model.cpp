#include "lod/manager/cost_model.h"

#include <algorithm>
#include <cmath>

namespace lodestone {
namespace {

// Asleep, alone, in a crowd: µs a step of bunnies of 4,698 faces, on one core of the machine that the README's figures are from.
constexpr double kTablesWork[] = {0.0, 0.05, 3.0};
constexpr double kSupportWork[] = {0.0, 0.6, 20.0};
constexpr double kFullWork[] = {2.0, 10.0, 100.0};
// A full body among others that touch costs so much more for each of them: meshes that meet are dear to collide.
constexpr double kFullWorkOfHeap = 22.0;
// A change: an entry in arrays, what touches it looked at for the first time, a mesh for ODE and whether it overlaps anything.
constexpr double kChangeWork[] = {2.0, 30.0, 100.0};
// Of what changes were found to cost in the step in which they are made, this much is forgotten in each step.
constexpr double kForgotten = 0.002;
constexpr double kOthersWork = 20.0, kAskedWork = 0.15;

// A body is charged a part of what it would cost in a crowd, by what it does: a flock of them lands within a few steps, or a heap wakes, and nobody foresees it.
constexpr double kChargeOfCrowd[] = {0.1, 0.15, 0.0};

// Weight of the newest step in a factor: a step that was dearer than predicted counts at once, one that was cheaper little by little.
constexpr double kRise = 0.5, kFall = 0.05;
constexpr double kFactorMin = 0.02, kFactorMax = 50.0;

// The margin follows the error that one step in a hundred exceeds. Each rung has a spread of its own, too, by which its bodies are charged more: two meshes that meet take
// a tenth of a millisecond in one step and eight in another.
constexpr double kMarginRise = 0.5, kMarginFall = 0.003, kMarginMax = 1.0, kSpreadMax = 8.0;

/// Follows `excess`, the part by which something exceeded its prediction: at once up, slowly down.
void follow(double& margin, double excess, double most) {
  margin = excess > margin ? std::min(most, margin + kMarginRise * (excess - margin)) : margin * (1.0 - kMarginFall);
}

double weight_of(double error) { return error > 1.0 ? kRise : kFall; }

}  // namespace

double work_of(Rung rung, Activity activity, int heap) {
  const auto of = std::size_t(activity);
  if (rung == Rung::tables) return kTablesWork[of];
  if (rung == Rung::support) return kSupportWork[of];
  return kFullWork[of] + (activity == Activity::crowded ? kFullWorkOfHeap * heap : 0.0);
}

double CostModel::factor(Rung rung, Activity activity) const {
  if (unit_ == Unit::work) return 1.0;
  return 1e-3 * factors_[std::size_t(rung)][std::size_t(activity)] * (1.0 + spread_[std::size_t(rung)]);
}

std::array<float, kRungs> CostModel::cost_of(Activity activity) const {
  std::array<float, kRungs> cost;
  for (const Rung rung : {Rung::tables, Rung::support, Rung::full}) cost[std::size_t(rung)] = float(work_of(rung, activity, heap_) * factor(rung, activity));
  for (const Rung rung : {Rung::support, Rung::full})
    if (rung == Rung::full || activity != Activity::asleep)  // statistical sleepers are in no loop, and change rung for nothing
      cost[std::size_t(rung)] += float(kChargeOfCrowd[std::size_t(activity)] * work_of(rung, Activity::crowded, awake_) * factor(rung, Activity::crowded));
  return cost;
}

StepOverhead CostModel::overhead(const StepCounts& counts) const {
  const double scale = unit_ == Unit::work ? 1.0 : 1e-3 * others_factor_;
  StepOverhead overhead{.others = scale * (kOthersWork + kAskedWork * counts.asked), .margin = unit_ == Unit::work ? 0.0 : margin_};
  for (std::size_t rung = 0; rung < kRungs; ++rung) overhead.change[rung] = scale * kChangeWork[rung] + (unit_ == Unit::work ? 0.0 : arrival_ms_[rung]);
  return overhead;
}

double CostModel::ms_of(const StepCounts& counts, Rung rung) const {
  double ms = 0.0;
  for (const Activity activity : {Activity::asleep, Activity::alone, Activity::crowded})
    ms += 1e-3 * factors_[std::size_t(rung)][std::size_t(activity)] * work_of(rung, activity, heap_) * counts.at(rung, activity);
  return ms;
}

void CostModel::predict(const StepCounts& counts, StepReport& report) const {
  double others = kOthersWork + kAskedWork * counts.asked;
  for (std::size_t rung = 0; rung < kRungs; ++rung) {
    RungCost& cost = report.cost[rung];
    cost.predicted_ms = ms_of(counts, Rung(rung));
    cost.work = 0.0;
    for (std::size_t activity = 0; activity < kActivities; ++activity) cost.work += work_of(Rung(rung), Activity(activity), heap_) * counts.bodies[rung][activity];
    cost.predicted_ms += arrival_ms_[rung] * counts.changes[rung];
    report.predicted_ms += cost.predicted_ms;
    others += kChangeWork[rung] * counts.changes[rung];
  }
  report.predicted_ms += 1e-3 * others_factor_ * others;
}

void CostModel::learn(const StepCounts& counts, const StepMeasurement& measured) {
  double charged_ms = 0.0;
  double others_ms = kOthersWork + kAskedWork * counts.asked;
  for (std::size_t rung = 0; rung < kRungs; ++rung) {
    others_ms += kChangeWork[rung] * counts.changes[rung];
    const double expected = ms_of(counts, Rung(rung));
    charged_ms += expected * (1.0 + spread_[rung]) + arrival_ms_[rung] * counts.changes[rung];
    arrival_ms_[rung] *= 1.0 - kForgotten;
    if (const int changes = counts.changes[rung]; changes > 0) {
      // What goes beyond the bodies' own cost is the arrivals'.
      const double each_ms = (measured.rungs_ms[rung] - expected) / changes;
      arrival_ms_[rung] += (each_ms > arrival_ms_[rung] ? kRise : kFall) * (std::max(0.0, each_ms) - arrival_ms_[rung]);
      continue;
    }
    if (expected < 1e-3) continue;  // a microsecond says nothing
    const double error = std::max(1e-3, measured.rungs_ms[rung] / expected);
    if (expected > 0.05) follow(spread_[rung], error - 1.0, kSpreadMax);
    for (std::size_t activity = 0; activity < kActivities; ++activity) {
      double& factor = factors_[rung][activity];
      const double share = 1e-3 * factor * work_of(Rung(rung), Activity(activity), heap_) * counts.bodies[rung][activity] / expected;
      factor = std::clamp(factor * std::pow(error, weight_of(error) * share), kFactorMin, kFactorMax);
    }
  }
  charged_ms += 1e-3 * others_factor_ * others_ms;
  const double error = std::max(1e-3, measured.others_ms / (1e-3 * others_factor_ * others_ms));
  others_factor_ = std::clamp(others_factor_ * std::pow(error, weight_of(error)), kFactorMin, kFactorMax);
  follow(margin_, measured.total_ms() / std::max(charged_ms, 1e-3) - 1.0, kMarginMax);
}

}  // namespace lodestone
