// An error budget: the same work, spent where it lessens the error in the picture most. Pebbles lie at the
// viewer's feet, boulders roll behind them.
#include <cmath>
#include <memory>
#include <vector>

#include "check.h"
#include "lod/manager.h"
#include "signature/signature_source.h"

using namespace lodestone;

namespace {

constexpr double kFrame = 1.0 / 60.0, kWork = 9000.0;
const auto kPebble = std::make_shared<const Shape>(make_shape("pebble", make_box({0.02, 0.03, 0.04})));
const auto kBoulder = std::make_shared<const Shape>(make_shape("boulder", make_box({1.0, 1.5, 2.0})));

struct Outcome {
  double error_px = 0;                      // mean over the steps of the sum that explain() predicts
  double reported_px = 0;                   // the same as the report has it
  double work = 0;                          // mean of what the rungs were predicted to cost
  int full_boulders = 0, full_pebbles = 0;  // at the end
  int changes = 0;
  std::uint64_t hash = 0;
};

/// Signatures whose errors on the rungs are known: by so much a body drifts in a second, over its size.
SignatureFunction with_drifts(double tables, double support, double full) {
  return [=](const Shape& shape, const ContactLaw& law) {
    Signature signature = *find_or_measure_signature(shape, law).signature;
    signature.rung_errors = {
        .tables = {0.3, tables}, .support = {0.1, support}, .full = {0.05, full}, .drops = 100};
    return std::make_shared<const Signature>(std::move(signature));
  };
}

Outcome run(const PolicySettings& policy, double drift_of_full = 0.1) {
  Manager manager({.sleeping = false, .policy = policy, .signatures = with_drifts(1.5, 0.5, drift_of_full)});
  manager.add_plane(Vec3::UnitZ(), 0.0);
  manager.set_viewpoints({Viewpoint{.position = {0, 0, 1.5}, .direction = Vec3(1, 0, 0)}});
  std::vector<BodyId> pebbles, boulders;
  for (int i = 0; i < 400; ++i)
    pebbles.push_back(
        manager.add_body({.shape = kPebble,
                          .state = {.position = {1.0 + 0.2 * (i % 20), 0.2 * (i / 20) - 2.0, 0.3},
                                    .angular_velocity = {3, 1, 0}}}));
  for (int i = 0; i < 20; ++i)
    boulders.push_back(
        manager.add_body({.shape = kBoulder,
                          .state = {.position = {9.0, 5.0 * (i - 10), 4.0}, .angular_velocity = {0, 1, 1}}}));
  Outcome outcome;
  const int frames = 240;
  for (int frame = 0; frame < frames; ++frame) {
    const StepReport& report = manager.step(kFrame);
    if (frame >= frames / 2) outcome.changes += report.promotions + report.demotions;
    for (const auto* bodies : {&pebbles, &boulders})
      for (const BodyId body : *bodies)
        outcome.error_px += manager.explain(body).predicted_error_pixels / frames;
    outcome.reported_px += report.predicted_error_pixels / frames;
    for (const RungCost& cost : report.cost) outcome.work += cost.work / frames;
  }
  for (const BodyId body : boulders) outcome.full_boulders += manager.rung(body) == Rung::full;
  for (const BodyId body : pebbles) outcome.full_pebbles += manager.rung(body) == Rung::full;
  outcome.hash = manager.state_hash();
  return outcome;
}

}  // namespace

int main() {
  const Outcome by_error = run({.policy = ErrorBudgetPolicy{.budget_work = kWork}}),
                again = run({.policy = ErrorBudgetPolicy{.budget_work = kWork}});
  const Outcome by_distance = run({.policy = WorkPolicy{kWork}});
  std::printf(
      "     error budget: %.0f px, %.0f units, %d boulders and %d pebbles full; nearest first: %.0f px, %.0f "
      "units, %d and %d\n",
      by_error.error_px, by_error.work, by_error.full_boulders, by_error.full_pebbles, by_distance.error_px,
      by_distance.work, by_distance.full_boulders, by_distance.full_pebbles);
  check::that(by_error.hash == again.hash, "counted work: the same run twice");
  check::within(by_error.error_px / by_distance.error_px, 0.0, 0.95,
                "predicted error in the picture, over that of the budget that takes the nearest");
  check::within(by_error.work, 0.0, kWork, "work units a step, of 9,000");
  check::that(by_error.full_boulders > by_distance.full_boulders, "more of the large bodies are full");
  check::within(by_error.reported_px / by_error.error_px, 0.8, 1.2,
                "the report's predicted error of the scene, over the sum of explain()");
  const Outcome no_gain = run({.policy = ErrorBudgetPolicy{.budget_work = kWork}}, 0.6);
  check::within(no_gain.full_boulders + no_gain.full_pebbles, 0, 0,
                "bodies full where that is no nearer to the truth than support");
  check::within(by_error.changes, 0, 42, "changes of rung in the last two of four seconds, of 420 bodies");
  return check::result();
}
