#include "lod/manager/finish_report.h"

namespace lodestone {
namespace {

/// What full bodies do now, and what the statistical ones did in the step.
StepCounts count_activities(const Levels& levels, const StepCounts& counts) {
  StepCounts done{.bodies = {}, .changes = counts.changes, .asked = counts.asked};
  for (const FullLevel::Member& member : levels.full.members()) {
    const bool asleep = levels.full.world()->asleep(member.id);
    ++done.at(Rung::full, asleep ? Activity::asleep : levels.full.touches(member.id) ? Activity::crowded : Activity::alone);
  }
  if (!levels.statistical) return done;
  done.bodies[std::size_t(Rung::tables)] = levels.statistical->cost().tables;
  done.bodies[std::size_t(Rung::support)] = levels.statistical->cost().support;
  return done;
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
  report.statistical = report.support + report.tables;
  report.counters.signatures_loaded = levels.signatures.loaded();
}

void report_cost(const Levels& levels, const StepCounts& counts, const StepMeasurement& measured, bool clocked, CostModel& costs, StepReport& report) {
  costs.predict(counts, report);
  const StepCounts done = count_activities(levels, counts);
  if (clocked) {
    for (std::size_t rung = 0; rung < kRungs; ++rung) report.cost[rung].measured_ms = measured.rungs_ms[rung];
    report.measured_ms = measured.total_ms();
    costs.learn(done, measured);
  }
  const int touching = done.at(Rung::full, Activity::crowded);
  costs.set_heap(touching, touching + done.at(Rung::full, Activity::alone));
}

}  // namespace lodestone
