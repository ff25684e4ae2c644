#include "lod/manager/manager_impl.h"

#include "reference/error.h"
#include "reference/ode/callers_bodies.h"

namespace lodestone {
namespace {

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

}  // namespace lodestone
