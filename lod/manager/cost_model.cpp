#include "lod/manager/cost_model.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lod/manager/share_of_full.h"

namespace lodestone {
namespace {

// µs a step of bunnies of 4,698 faces, on one core of the machine that the figures of tools/README.md are
// from: asleep, alone, in a crowd, arriving, of full bodies, joined.
constexpr std::array<Charges, kRungs> kWork{{{0.0, 0.4, 0.8, 0.2, 0.0, 0.0},
                                             {0.0, 0.6, 30.0, 100.0, 50.0, 0.0},
                                             {2.0, 10.0, 50.0, 20.0, 500.0, 400.0}}};
// A change: entries in arrays, for the full level a mesh for ODE and whether it overlaps anything.
constexpr double kChangeWork[] = {2.0, 10.0, 100.0};
// Of a bunny's, what a box costs: .32 in a flight and landing (tools/README.md, single drops).
constexpr double kLeastShare = 0.3;

// µs besides the rungs (choice, transfer, contacts between levels, report): of any step, of each body that
// the policy is asked about, of each new body.
constexpr double kOthersWork = 20.0, kAskedWork = 0.15, kAddedWork = 1.5;

// What the dearest pair of meshes is charged once, µs: several times what one was seen to cost in a step.
// With less no more bodies are full in the end, as the margin then keeps the reserve, and half as many are at
// `support`.
constexpr double kSpikeWork = 50e3;

// One that is alone is charged a part of what it would cost in a crowd: a flock of them lands within a few
// steps.
constexpr double kChargeOfCrowd = 0.15;

// Weight of the newest step in a factor, and what of an error counts at most, as a part of what was expected,
// in a first bad step and in the next ones: one spike does not make a price.
constexpr double kNewest = 0.2, kErrorFirst = 0.5, kErrorMost = 2.0;
// By so much in each step the factors of what is awake on a rung come nearer to their mean: what one charge
// costs is not told from another that always comes with it. Of those that are not there nothing is told, and
// sleepers, which there are for long without the others, tell nothing of these.
constexpr double kCommon = 0.01;
constexpr double kFactorMin = 0.02, kFactorMax = 50.0;

// The margin goes up by so much where a step exceeds it, and down by so much less where it does not, that one
// in kStepsWithin does.
constexpr double kMarginUp = 0.05, kStepsWithin = 100.0, kMarginMax = 2.0;
// Of the budget: a shorter step does no harm, whatever was foretold, and one that was foretold to be shorter
// says nothing.
constexpr double kHarm = 0.9, kShortest = 0.4;

double learnt(double factor, double weight, double error) {
  return std::clamp(factor * (1.0 + kNewest * weight * std::min(error, kErrorMost)), kFactorMin, kFactorMax);
}

}  // namespace

double CostModel::full_share(float mesh_weight) const {
  return unit_ == Unit::work ? 1.0 : std::clamp(double(mesh_weight), kLeastShare, 1.0);
}

double work_of(Rung rung, std::size_t charge) { return kWork[std::size_t(rung)][charge]; }

double CostModel::price(Rung rung, std::size_t charge) const {
  const double work = work_of(rung, charge);
  return unit_ == Unit::work ? work : ms_of_one(rung, charge);
}

double CostModel::ms_of_one(Rung rung, std::size_t charge) const {
  return 1e-3 * factors_[std::size_t(rung)][charge] * work_of(rung, charge);
}

std::array<float, kRungs> CostModel::cost_of(Activity activity, double share) const {
  std::array<float, kRungs> cost;
  for (const Rung rung : {Rung::tables, Rung::support, Rung::full}) {
    const double part = rung == Rung::full ? share : 1.0;
    double charged = part * price(rung, std::size_t(activity));
    const double contacts = rung == Rung::full ? price(Rung::support, kOfFull) : 0.0;
    const double in_crowd = part * price(rung, std::size_t(Activity::crowded)) + contacts;
    if (activity == Activity::crowded) charged = in_crowd;
    if (activity == Activity::alone && rung != Rung::tables) charged += kChargeOfCrowd * in_crowd;
    if (activity == Activity::asleep && rung != Rung::tables)
      charged = std::max(charged, kChargeOfSleepers * (in_crowd + part * price(rung, kArriving)));
    cost[std::size_t(rung)] = float(charged);
  }
  return cost;
}

double CostModel::cost_of_forced_full(Activity activity, bool held, double share) const {
  const double contacts = activity == Activity::crowded ? price(Rung::support, kOfFull) : 0.0;
  return share * price(Rung::full, held ? kJoined : std::size_t(activity)) + contacts;
}

StepOverhead CostModel::overhead(const StepCounts& counts) const {
  const bool timed = unit_ == Unit::milliseconds;
  const double scale = timed ? 1e-3 * others_factor_ : 1.0,
               scale_of_changes = timed ? 1e-3 * changes_factor_ : 1.0;
  StepOverhead overhead{.others = scale * (kOthersWork + kAskedWork * counts.asked),
                        .pair = price(Rung::full, kOfFull)};
  for (const Rung rung : {Rung::tables, Rung::support, Rung::full})
    overhead.change[std::size_t(rung)] =
        scale_of_changes * kChangeWork[std::size_t(rung)] + price(rung, kArriving);
  if (timed)
    overhead.margin = margin_, overhead.spike = 1e-3 * kSpikeWork,
    overhead.others += scale * kAddedWork * counts.added;
  return overhead;
}

double CostModel::ms_of(const StepCounts& counts, Rung rung) const {
  double ms = 0.0;
  for (std::size_t charge = 0; charge < kCharges; ++charge)
    ms += 1e-3 * factors_[std::size_t(rung)][charge] * work_of(rung, charge) *
          counts.rungs[std::size_t(rung)][charge];
  return ms;
}

double CostModel::others_ms(const StepCounts& counts) const {
  return 1e-3 * others_factor_ * (kOthersWork + kAskedWork * counts.asked + kAddedWork * counts.added);
}

double CostModel::changes_ms(const StepCounts& counts) const {
  double work = 0.0;
  for (std::size_t rung = 0; rung < kRungs; ++rung) work += kChangeWork[rung] * counts.changes[rung];
  return 1e-3 * changes_factor_ * work;
}

void CostModel::predict(const StepCounts& counts, StepReport& report) const {
  for (std::size_t rung = 0; rung < kRungs; ++rung) {
    RungCost& cost = report.cost[rung];
    cost.predicted_ms = ms_of(counts, Rung(rung));
    cost.work = 0.0;
    for (std::size_t charge = 0; charge < kCharges; ++charge)
      cost.work += work_of(Rung(rung), charge) * counts.rungs[rung][charge];
    report.predicted_ms += cost.predicted_ms;
  }
  report.predicted_ms += others_ms(counts) + changes_ms(counts);
}

void CostModel::learn(double budget_ms, double predicted_ms, const StepCounts& counts,
                      const StepMeasurement& measured) {
  for (std::size_t rung = 0; rung < kRungs; ++rung)
    learn_rung(rung, counts.rungs[rung], measured.rungs_ms[rung]);
  const double others = others_ms(counts), changes = changes_ms(counts),
               error = measured.others_ms / (others + changes) - 1.0;
  others_factor_ = learnt(others_factor_, others / (others + changes), error);
  changes_factor_ = learnt(changes_factor_, changes / (others + changes), error);
  if (std::max(predicted_ms, measured.total_ms()) < kShortest * budget_ms) return;
  const bool within = measured.total_ms() <= std::max(predicted_ms * (1.0 + margin_), kHarm * budget_ms);
  margin_ = std::clamp(margin_ + kMarginUp * (within ? -1.0 / kStepsWithin : 1.0), 0.0, kMarginMax);
}

// Each charge answers for an error by its share in what was expected.
void CostModel::learn_rung(std::size_t rung, const Charges& charges, double measured_ms) {
  constexpr auto kAsleep = std::size_t(Activity::asleep);
  Charges share{};
  double expected_ms = 0.0, awake_work = 0.0;
  for (std::size_t charge = 0; charge < kCharges; ++charge) {
    const double work = work_of(Rung(rung), charge) * charges[charge];
    expected_ms += share[charge] = 1e-3 * factors_[rung][charge] * work;
    if (charge != kAsleep) awake_work += work;
  }
  if (expected_ms < 1e-3) return;  // a microsecond says nothing
  const double last = std::exchange(last_error_[rung], measured_ms / expected_ms - 1.0),
               mean = awake_work > 0.0 ? 1e3 * (expected_ms - share[kAsleep]) / awake_work : 1.0;
  const double error = std::min(last_error_[rung], std::max(kErrorFirst, last));
  for (std::size_t charge = 0; charge < kCharges; ++charge) {
    double& factor = factors_[rung][charge];
    const double common = charge != kAsleep && share[charge] > 0.0 ? std::pow(mean / factor, kCommon) : 1.0;
    factor = learnt(factor, share[charge] / expected_ms, error) * common;
  }
}

}  // namespace lodestone
