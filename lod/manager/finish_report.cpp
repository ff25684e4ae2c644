#include "lod/manager/finish_report.h"

#include <algorithm>

#include "reference/ode/body_joints.h"

namespace lodestone {
namespace {

/// What full bodies do now, and what the statistical ones did in the step; who arrived, and the pairs, as the
/// step had them.
StepCounts count_activities(const Levels& levels, const CostModel& costs, StepCounts counts) {
  const auto set = [&](Rung rung, const auto& bodies) {
    std::ranges::copy(bodies, counts.rungs[std::size_t(rung)].begin());
  };
  std::array<double, kActivities> full{};
  double held = 0.0;
  int touching = 0;
  for (const FullLevel::Member& member : levels.full.members()) {
    const bool asleep = levels.full.world()->asleep(member.id),
               touches = !asleep && levels.full.touches(member.id);
    const double share = costs.full_share(mesh_weight(*levels.bodies.shape(member.owner)));
    touching += touches;
    if (!asleep && has_joints(levels.full.world()->ode_body(member.id)))
      held += share;
    else
      full[std::size_t(asleep ? Activity::asleep : touches ? Activity::crowded : Activity::alone)] += share;
  }
  set(Rung::full, full);
  counts.rungs[std::size_t(Rung::full)][kJoined] = held;
  counts.rungs[std::size_t(Rung::support)][kOfFull] = touching;
  set(Rung::tables, levels.statistical ? levels.statistical->cost().tables : std::array<int, kActivities>{});
  set(Rung::support,
      levels.statistical ? levels.statistical->cost().support : std::array<int, kActivities>{});
  return counts;
}

}  // namespace

void report_bodies(const Levels& levels, StepReport& report) {
  report.full = int(levels.full.members().size());
  report.asleep = levels.full.asleep_count();
  if (levels.statistical) {
    report.support = levels.statistical->size(StatisticalModel::support);
    report.tables = levels.statistical->size(StatisticalModel::tables);
    report.asleep += levels.statistical->asleep_count();
  }
  for (std::size_t i = 0; i < levels.bodies.newcomers().size(); ++i)
    report.support += levels.bodies.waits_at(i);  // held back: as rung() has it
  report.statistical = report.support + report.tables;
  report.counters.signatures_loaded = levels.signatures.loaded();
}

void report_cost(const Levels& levels, const StepCounts& counts, const StepMeasurement& measured,
                 std::optional<double> budget_ms, CostModel& costs, StepReport& report) {
  costs.predict(counts, report);
  if (!budget_ms) return;
  for (std::size_t rung = 0; rung < kRungs; ++rung) report.cost[rung].measured_ms = measured.rungs_ms[rung];
  report.measured_ms = measured.total_ms();
  costs.learn(*budget_ms, report.predicted_ms, count_activities(levels, costs, counts), measured);
}

}  // namespace lodestone
