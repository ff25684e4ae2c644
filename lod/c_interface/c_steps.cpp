// Steps, and what they came to: report, audit, counts.
#include "lod/c_interface/c_values.h"

using namespace lodestone;
using namespace lodestone::c;

namespace {

lodestone_stage_times times_of(const StageTimes& t) {
  return {t.choose_ms, t.transfer_ms, t.flight_ms,      t.broad_phase_ms, t.pairs_ms,
          t.crowd_ms,  t.rest_ms,     t.cross_level_ms, t.full_ms,        t.total_ms};
}

lodestone_counters counters_of(const Counters& c) {
  return {c.ode_bodies_created,   c.trimeshes_built,       c.signatures_loaded,    c.pair_phases,
          c.ode_messages,         c.contacts_dropped,      c.states_recovered,     c.full_quick_steps,
          c.full_swallowed,       c.full_passes_prevented, c.full_uneven_contacts, c.energy_clamps,
          c.table_extrapolations, c.levels_considered,     c.promotions_put_off,   c.divided_steps,
          c.bodies_held_back};
}

lodestone_report report_of(const StepReport& r) {
  lodestone_report report{.step = r.step,
                          .dt_s = r.dt_s,
                          .full = r.full,
                          .support = r.support,
                          .tables = r.tables,
                          .asleep = r.asleep,
                          .promotions = r.promotions,
                          .demotions = r.demotions,
                          .contacts = r.contacts,
                          .times = times_of(r.times),
                          .cost = {},
                          .predicted_ms = r.predicted_ms,
                          .measured_ms = r.measured_ms,
                          .predicted_error_pixels = r.predicted_error_pixels,
                          .counters = counters_of(r.counters)};
  for (std::size_t rung = 0; rung < kRungs; ++rung)
    report.cost[rung] = {r.cost[rung].predicted_ms, r.cost[rung].measured_ms, r.cost[rung].work};
  return report;
}

lodestone_audit_figure figure_of(const AuditFigure& f) {
  return {f.full, f.demoted, f.deviation, f.difference[0], f.difference[1]};
}

lodestone_audit audit_of(const AuditReport& a) {
  return {a.bodies,
          a.watched,
          a.left_out,
          figure_of(a.rest_time_s),
          figure_of(a.distance_m),
          figure_of(a.rest_height),
          a.drift,
          a.drift_interval[0],
          a.drift_interval[1],
          a.spent_ms};
}

}  // namespace

lodestone_result lodestone_step(lodestone_manager* manager, double dt, lodestone_report* report) {
  return guarded([&] { give(report, report_of(of(manager).step(dt))); });
}

lodestone_result lodestone_before_world_step(lodestone_manager* manager, double dt) {
  return guarded([&] { of(manager).before_world_step(dt); });
}

lodestone_result lodestone_after_world_step(lodestone_manager* manager, lodestone_report* report) {
  return guarded([&] { give(report, report_of(of(manager).after_world_step())); });
}

lodestone_result lodestone_get_report(const lodestone_manager* manager, lodestone_report* report) {
  return guarded([&] { give(report, report_of(of(manager).report())); });
}

lodestone_result lodestone_get_audit(const lodestone_manager* manager, lodestone_audit* audit) {
  return guarded([&] { give(audit, audit_of(of(manager).report().audit)); });
}

lodestone_result lodestone_body_count(const lodestone_manager* manager, size_t* count) {
  return guarded([&] { give(count, std::size_t(of(manager).bodies())); });
}

lodestone_result lodestone_state_hash(const lodestone_manager* manager, uint64_t* hash) {
  return guarded([&] { give(hash, of(manager).state_hash()); });
}
