// A step, top down:
// - step() takes it at once (step_part), or a long one in parts (step_divided). A part is begin_stages
// (stages
//   1 to 3), StepLevels::step_full (4) and end_stages (5).
// - before_world_step() and after_world_step() do the same around the caller's own world step, which is 4.
// Around either, begin_lists() and finish_lists() keep what moved(), woke() and the like tell of the step.
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

constexpr double kLongestPart = 0.1;  // s: a longer step is divided

// Whether the policy has a budget: then costs are measured and learnt.
bool is_budgeted(const PolicySettings& policy) { return !limits_of(policy); }

/// Adds what stage 3 cost, `ms` in all: each rung's part to that rung, the rest to nobody's.
void add_statistical_cost(const Levels& levels, double ms, StepMeasurement& measured) {
  if (levels.statistical && levels.statistical->size() > 0) {
    measured.rungs_ms[std::size_t(Rung::tables)] = levels.statistical->cost().tables_ms;
    measured.rungs_ms[std::size_t(Rung::support)] = levels.statistical->cost().support_ms;
  }
  measured.others_ms += std::max(0.0, ms - measured.total_of_rungs_ms());
}

// In a divided step ground that was moved for it moves on from part to part, and is put back after the last.
class GroundInParts {
 public:
  explicit GroundInParts(Levels& levels) : levels_(levels) {}
  ~GroundInParts() { levels_.ground.come_back(), levels_.full.go_on(0.0); }
  GroundInParts(const GroundInParts&) = delete;
  GroundInParts& operator=(const GroundInParts&) = delete;
  void go_on(double gone) const { levels_.ground.go_on(), levels_.full.go_on(gone); }

 private:
  Levels& levels_;
};

}  // namespace

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
  const Impl::UndoOnThrow undo(impl);
  impl.begin_stages(dt, dt, WorldStepBy::caller);  // 1 to 3; 4 is the caller's own world step
  impl.step_levels.begin_callers_step(dt);
  impl.waits_for_world_step = true;
  impl.queries.begin_callers_step();
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

// The report is that of all parts together. Forces that were given for the step act in each part.
void Manager::Impl::step_divided(double dt, int parts) {
  const BodyTable::Forces forces = levels.bodies.forces();
  const GroundInParts ground(levels);
  StepReport sum;
  for (int i = 0; i < parts; ++i) {
    if (i > 0) ground.go_on(i * (dt / parts));
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

Manager::Impl::UndoOnThrow::~UndoOnThrow() {
  if (std::uncaught_exceptions() == exceptions_) {
    impl_.levels.ground.keep_step();
    return;
  }
  impl_.report = before_;
  impl_.levels.now = before_.step;
  impl_.levels.look_away();
  impl_.levels.ground.undo_step();
  BodyTable& bodies = impl_.levels.bodies;
  // the policy is to be asked about them anew in the next step
  for (std::uint32_t body = 0; body < bodies.indices(); ++body)
    bodies.level(body).looked_at = std::min(bodies.level(body).looked_at, before_.step);
}

void Manager::Impl::step_part(double dt, double since) {
  const UndoOnThrow undo(*this);
  begin_stages(dt, since, WorldStepBy::manager);  // 1 choose, 2 transfer, 3 statistical rungs
  step_levels.step_full(dt, report);              // 4 full level
  end_stages();                                   // 5 report
  changes.take_part();
}

void Manager::Impl::begin_stages(double dt, double since, WorldStepBy by) {
  begin_report(dt);
  const StageTimer timer(report.times.total_ms);
  follow_caller(dt, since);
  const std::optional<RungChanges> rung_changes = choose_rungs();  // 1
  if (rung_changes) move_bodies.run(*rung_changes, report);        // 2
  changes.note_promoted();
  if (is_budgeted(choose.policy())) choose.count_meetings();
  underway->measured.others_ms += underway->laps.lap_ms();
  step_statistical(dt, by);  // 3
}

void Manager::Impl::end_stages() {
  take_over_full();  // of 4
  finish_report();   // 5
  levels.bodies.reuse_indices();
}

void Manager::Impl::begin_report(double dt) {
  report = {.step = report.step + 1, .times = {}, .counters = report.counters};
  levels.now = report.step;
  const PolicySettings& policy = choose.policy();
  const bool clocked = is_budgeted(policy) && !counts_work(policy);
  if (levels.statistical) levels.statistical->set_clocked(clocked);
  step_log.begin_step(report.counters);
  underway.emplace(Underway{dt, ThreadLaps(clocked)});
}

// Takes over what the caller has put, moved or taken away since the last step.
void Manager::Impl::follow_caller(double dt, double since) {
  levels.follow_callers_space(dt, since);
  levels.ground.begin_step(dt, since, [&](const Eigen::AlignedBox3d& box) { levels.wake_piled_in(box); });
  left_places.wake(levels);
  audit.begin_step();
}

// 1 choose rungs
std::optional<RungChanges> Manager::Impl::choose_rungs() {
  move_bodies.count_down_retries();
  move_bodies.supply_signatures();
  if (!choose.groups().empty()) move_bodies.bring_back_woken(Groups::Return::awake, report);
  std::optional<RungChanges> rung_changes = choose.run(report, costs);
  if (rung_changes) find_signatures(*rung_changes);
  return rung_changes;
}

// Gets the signatures that the changes need before anything is moved, since this may throw.
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

// 3 statistical rungs, and their contacts with full bodies
void Manager::Impl::step_statistical(double dt, WorldStepBy by) {
  if (levels.statistical) levels.statistical->set_log(events.log());
  step_levels.step_statistical(dt, by, report);
  if (levels.statistical) choose.note_carriers(levels.statistical->carriers());
  if (!choose.groups().empty()) move_bodies.bring_back_woken(Groups::Return::as_it_slept, report);
  add_statistical_cost(levels, underway->laps.lap_ms(), underway->measured);
  // for 4: ODE is to record touches where events are wanted
  if (levels.full.world()) levels.full.world()->record_touches(events.wanted());
}

// 4 full level: takes over its times and touches
void Manager::Impl::take_over_full() {
  underway->measured.rungs_ms[std::size_t(Rung::full)] = underway->laps.lap_ms();
  report.times.total_ms += report.times.full_ms;
  events.take_full_touches();
}

// 5 report
void Manager::Impl::finish_report() {
  report_bodies(levels, report);
  report.predicted_error_pixels = choose.predicted_error();
  const PolicySettings& policy = choose.policy();
  if (is_budgeted(policy)) {
    step_levels.note_touching();
    underway->measured.others_ms += underway->laps.lap_ms();
    report_cost(levels, choose.counts(), underway->measured,
                counts_work(policy) ? std::nullopt : std::optional(budget_of(policy)), costs, report);
  }
  audit.end_step(underway->dt, report);
  const bool decides =
      levels.bodies.count(LevelChoice::automatic) + levels.bodies.count(LevelChoice::statistical) > 0;
  step_log.end_step(report, decides && choose.views().empty());
}

}  // namespace lodestone
