#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lod/manager/finish_report.h"
#include "lod/manager/manager_impl.h"
#include "lod/manager/transfer.h"
#include "lod/timing/stage_timer.h"
#include "lod/timing/stage_zones.h"
#include "lod/timing/thread_clock.h"
#include "reference/error.h"
#include "reference/ode/callers_bodies.h"

namespace lodestone {
namespace {

constexpr double kLongestPart = 0.1;  // s, of a step

JobRunner runner_of(const ManagerSettings& settings) {
  return settings.jobs ? settings.jobs : make_job_runner(settings.threads);
}

std::shared_ptr<CallersJobs> callers_of(const ManagerSettings& settings) {
  return settings.jobs ? std::make_shared<CallersJobs>(settings.jobs) : nullptr;
}

JobRunner in_steps(const std::shared_ptr<JobRunner>& jobs, const std::shared_ptr<CallersJobs>& callers) {
  if (callers) return [callers](std::int64_t count, TaskRef task) { (*callers)(count, task); };
  return [jobs](std::int64_t count, TaskRef task) { (*jobs)(count, task); };
}

StatisticalSettings statistical_settings(const ManagerSettings& settings, JobRunner jobs,
                                         const Vec3& gravity) {
  return {.gravity = gravity,
          .seed = settings.seed,
          .threads = settings.threads,
          .jobs = std::move(jobs),
          .tables = settings.tables,
          .sleeping = settings.sleeping,
          .sleep = settings.sleep};
}

FullSettings full_settings(const ManagerSettings& settings) {
  return {.gravity = settings.gravity,
          .seed = settings.seed,
          .substeps = settings.full_substeps,
          .sleeping = settings.sleeping,
          .sleep = settings.sleep};
}

/// Of a statistical stage that took `ms` in all.
void add_statistical(const Levels& levels, double ms, StepMeasurement& measured) {
  if (levels.statistical && levels.statistical->size() > 0) {
    measured.rungs_ms[std::size_t(Rung::tables)] = levels.statistical->cost().tables_ms;
    measured.rungs_ms[std::size_t(Rung::support)] = levels.statistical->cost().support_ms;
  }
  measured.others_ms += std::max(0.0, ms - measured.total_of_rungs_ms());
}

}  // namespace

Manager::Impl::Impl(const ManagerSettings& s)
    : jobs(std::make_shared<JobRunner>(runner_of(s))),
      callers_jobs(callers_of(s)),
      levels(statistical_settings(s, in_steps(jobs, callers_jobs), s.gravity), full_settings(s),
             SignatureStore(s.signatures, s.signature_timing)),
      choose(levels, s.policy, s.model),
      audit(levels, full_settings(s), s.audit_ms),
      events(levels, s.events) {
  set_up(s);
}
Manager::Impl::Impl(dxWorld* world, dxSpace* space, const ManagerSettings& s)
    : jobs(std::make_shared<JobRunner>(runner_of(s))),
      callers_jobs(callers_of(s)),
      levels(world, space, statistical_settings(s, in_steps(jobs, callers_jobs), callers::gravity(world)),
             full_settings(s), SignatureStore(s.signatures, s.signature_timing)),
      choose(levels, s.policy, s.model),
      audit(levels, full_settings(s), s.audit_ms),
      events(levels, s.events),
      callers_world(world) {
  set_up(s);
}

// What the statistical level, made later, refers to here.
void Manager::Impl::set_up(const ManagerSettings& settings) {
  levels.statistical_settings.properties = &levels.bodies.own_properties();
  if (!settings.pair_filter) return;
  levels.statistical_settings.pair_filter = [filter = settings.pair_filter, &bodies = levels.bodies](
                                                std::uint32_t a, std::uint32_t b) {
    const bool own = a < bodies.indices() && b < bodies.indices();  // the caller's bodies are beyond
    return !own || filter(bodies.id(a), bodies.id(b));
  };
  levels.full.set_pair_filter(levels.statistical_settings.pair_filter);
}

Manager::Manager(const ManagerSettings& settings) : impl_(std::make_unique<Impl>(checked(settings))) {}
Manager::Manager(dxWorld* world, dxSpace* space, const ManagerSettings& settings) {
  if (!world || !space) throw_input_error("world and space", "a null one", "the caller's own");
  impl_ = std::make_unique<Impl>(world, space, checked(settings));
}
Manager::~Manager() = default;
Manager::Manager(Manager&&) noexcept = default;
Manager& Manager::operator=(Manager&&) noexcept = default;

const StepReport& Manager::step(double dt) {
  check_step(dt);
  Impl& impl = *impl_;
  if (impl.waits_for_world_step)
    throw_input_error("step", "one between before_world_step and after_world_step", "none");
  if (dt == 0.0) {
    impl.begin_lists();
    impl.report.dt_s = 0.0;
    return impl.report;
  }
  const StageZones zones(impl.profile, impl.report.times);
  impl.follow_gravity();
  impl.begin_lists();
  if (const int parts = int(std::ceil(dt / kLongestPart)); parts > 1)
    impl.step_divided(dt, parts);
  else
    impl.step_part(dt, dt);
  return impl.finish_lists(dt, WorldStepBy::manager);
}

void Manager::before_world_step(double dt) {
  Impl& impl = *impl_;
  if (!impl.callers_world) throw_input_error("world", "the manager's own", "the caller's");
  if (impl.waits_for_world_step) throw_input_error("before_world_step", "a second one", "after_world_step");
  if (!(dt > 0.0 && dt <= kLongestPart))
    throw_input_error("time step", fmt::format("{:g} s", dt),
                      fmt::format("more than 0, at most {:g} s", kLongestPart));
  check_step(dt);
  const StageZones zones(impl.profile, impl.report.times);
  impl.follow_gravity();
  impl.begin_lists();
  const Impl::Undo undo(impl);
  impl.begin_stages(dt, dt, WorldStepBy::caller);  // 1 to 3; 4 is the caller's own world step
  impl.step_levels.begin_callers_step(dt);
  impl.waits_for_world_step = true;
}

const StepReport& Manager::after_world_step() {
  Impl& impl = *impl_;
  if (!impl.waits_for_world_step)
    throw_input_error("after_world_step", "none before it", "before_world_step");
  const StageZones zones(impl.profile, impl.report.times);
  impl.waits_for_world_step = false;
  const double dt = impl.underway->dt;
  impl.step_levels.end_callers_step(impl.report.counters);
  impl.end_stages();  // 5
  impl.changes.take_part();
  return impl.finish_lists(dt, WorldStepBy::caller);
}

void Manager::Impl::begin_lists() {
  changes.begin();
  events.begin();
}

const StepReport& Manager::Impl::finish_lists(double dt, WorldStepBy by) {
  changes.finish();
  left_places.follow(levels, changes.fell_asleep(), changes.moved_and_slept(), changes.woke());
  for (const BodyId body : changes.fell_asleep()) choose.note(body.index);  // whoever laid it to sleep
  events.finish(dt, changes.woke());
  queries.finish(changes.fell_asleep(), changes.moved_and_slept());
  report.dt_s = dt;
  const Call call = by == WorldStepBy::manager ? Call::step : Call::callers_step;
  if (recorder.on()) recorder.note(call, dt, body_hashes(levels));
  if (callers_jobs) callers_jobs->rethrow();
  recorder.rethrow();
  return report;
}

void Manager::Impl::follow_gravity() {
  if (!callers_world) return;
  const Vec3 gravity = callers::gravity(callers_world);
  if (gravity == levels.statistical_settings.gravity) return;
  check_finite(gravity, "gravity of the caller's world");
  levels.set_gravity(gravity);
}

// The report is that of all parts together. Forces last as long as all of them.
void Manager::Impl::step_divided(double dt, int parts) {
  const BodyTable::Forces forces = levels.bodies.forces();
  StepReport sum;
  for (int i = 0; i < parts; ++i) {
    if (i > 0) levels.bodies.hold(forces);
    if (i > 0 && callers_world) levels.full.world()->repeat_callers_forces();
    step_part(dt / parts, i == 0 ? dt : 0.0);
    sum.times += report.times;
    sum.promotions += report.promotions, sum.demotions += report.demotions;
    sum.bytes_moved += report.bytes_moved, sum.contacts += report.contacts;
    sum.predicted_ms += report.predicted_ms, sum.measured_ms += report.measured_ms;
  }
  report.times = sum.times;
  report.promotions = sum.promotions, report.demotions = sum.demotions;
  report.bytes_moved = sum.bytes_moved, report.contacts = sum.contacts;
  report.predicted_ms = sum.predicted_ms, report.measured_ms = sum.measured_ms;
  ++report.counters.divided_steps;
}

Manager::Impl::Undo::~Undo() {
  if (std::uncaught_exceptions() == exceptions_) return;
  impl_.report = before_;
  impl_.levels.now = before_.step;
  impl_.levels.look_away();
  BodyTable& bodies = impl_.levels.bodies;
  // they are looked at anew in the step to come
  for (std::uint32_t body = 0; body < bodies.indices(); ++body)
    bodies.level(body).looked_at = std::min(bodies.level(body).looked_at, before_.step);
}

void Manager::Impl::step_part(double dt, double since) {
  const Undo undo(*this);
  begin_stages(dt, since, WorldStepBy::manager);  // 1 choose, 2 transfer, 3 statistical rungs
  step_levels.step_full(dt, report);              // 4 full level
  end_stages();                                   // 5 report
  changes.take_part();
}

// Before anything is moved: they may not be there.
void Manager::Impl::find_signatures(const RungChanges& rung_changes) {
  std::vector<std::uint32_t> to_full;
  for (const auto* list : {&rung_changes.demote, &rung_changes.promote})
    for (const RungChanges::Change& change : *list) {
      if (change.to == Rung::full)
        to_full.push_back(change.body);
      else
        find_signature(levels, change.body, change.to);
    }
  std::ranges::sort(to_full);
  const auto& newcomers = levels.bodies.newcomers();
  for (std::size_t i = 0; i < newcomers.size(); ++i)
    if (levels.bodies.waits_at(i) && !std::ranges::binary_search(to_full, newcomers[i].index))
      find_signature(levels, newcomers[i].index, newcomers[i].rung);
}

void Manager::Impl::begin_stages(double dt, double since, WorldStepBy by) {
  report = {.step = report.step + 1, .times = {}, .counters = report.counters};
  levels.now = report.step;
  const PolicySettings& policy = choose.policy();
  const bool budgeted = !limits_of(policy), clocked = budgeted && !counts_work(policy);
  if (levels.statistical) levels.statistical->set_clocked(clocked);
  step_log.begin_step(report.counters);
  underway.emplace(Underway{dt, ThreadLaps(clocked)});
  auto& [_, laps, measured] = *underway;
  const StageTimer timer(report.times.total_ms);
  levels.follow_callers_space(dt, since);
  levels.ground.begin_step(dt, since, [&](const Eigen::AlignedBox3d& box) { levels.wake_piled_in(box); });
  left_places.wake(levels);
  audit.begin_step();
  // 1 choose rungs
  move_bodies.count_down_retries();
  move_bodies.supply_signatures();
  if (!choose.groups().empty()) move_bodies.bring_back_woken(Groups::Return::awake, report);
  const std::optional<RungChanges> rung_changes = choose.run(report, costs);
  if (rung_changes) find_signatures(*rung_changes);
  // 2 transfer
  if (rung_changes) move_bodies.run(*rung_changes, report);
  if (budgeted) choose.count_meetings();
  measured.others_ms += laps.lap_ms();
  // 3 statistical rungs and their contacts with full bodies
  if (levels.statistical) levels.statistical->set_log(events.log());
  step_levels.step_statistical(dt, by, report);
  if (levels.statistical) choose.note_carriers(levels.statistical->carriers());
  if (!choose.groups().empty()) move_bodies.bring_back_woken(Groups::Return::as_it_slept, report);
  add_statistical(levels, laps.lap_ms(), measured);
  // for 4: ODE is to tell of touches that events want
  if (levels.full.world()) levels.full.world()->record_touches(events.wanted());
}

void Manager::Impl::end_stages() {
  auto& [dt, laps, measured] = *underway;
  measured.rungs_ms[std::size_t(Rung::full)] = laps.lap_ms();
  report.times.total_ms += report.times.full_ms;
  events.take_full_touches();
  // 5 report
  report_bodies(levels, report);
  report.predicted_error_pixels = choose.predicted_error();
  const PolicySettings& policy = choose.policy();
  if (!limits_of(policy)) {
    step_levels.note_touching();
    measured.others_ms += laps.lap_ms();
    report_cost(levels, choose.counts(), measured,
                counts_work(policy) ? std::nullopt : std::optional(budget_of(policy)), costs, report);
  }
  audit.end_step(dt, report);
  step_log.end_step(report);
  levels.bodies.reuse_indices();
}

}  // namespace lodestone
