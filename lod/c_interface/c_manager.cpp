// A manager and its settings: policy, viewpoints, gravity, events.
#include "lod/c_interface/c_values.h"

using namespace lodestone;
using namespace lodestone::c;

namespace {

PolicySettings policy_of(const lodestone_policy& policy) {
  PolicySettings settings;
  settings.hysteresis = policy.hysteresis;
  settings.min_dwell_frames = policy.min_dwell_frames,
  settings.max_transitions_per_frame = policy.max_transitions_per_frame;
  settings.most_full = policy.most_full, settings.most_support = policy.most_support;
  settings.out_of_view_factor = policy.out_of_view_factor, settings.look_ahead_s = policy.look_ahead_s;
  settings.contact_groups_together = policy.contact_groups_together;
  if (policy.visible)
    settings.visible = [visible = policy.visible, context = policy.context](const Vec3& center,
                                                                            double radius) {
      return visible(context, vec3(center), radius);
    };
  if (policy.significance)
    settings.significance = [significance = policy.significance, context = policy.context](BodyId id) {
      return significance(context, body(id));
    };
  switch (policy.kind) {
    case LODESTONE_POLICY_DISTANCE:
      settings.policy = DistancePolicy{policy.full_within, policy.support_within};
      return settings;
    case LODESTONE_POLICY_BUDGET_MS:
      settings.policy = BudgetPolicy{policy.budget};
      return settings;
    case LODESTONE_POLICY_BUDGET_WORK:
      settings.policy = WorkPolicy{policy.budget};
      return settings;
    case LODESTONE_POLICY_PROJECTED_SIZE:
      settings.policy = ProjectedSizePolicy{policy.full_above_px, policy.support_above_px};
      return settings;
    case LODESTONE_POLICY_ERROR_BUDGET_MS:
      settings.policy = ErrorBudgetPolicy{.budget_ms = policy.budget};
      return settings;
    case LODESTONE_POLICY_ERROR_BUDGET_WORK:
      settings.policy = ErrorBudgetPolicy{.budget_work = policy.budget};
      return settings;
  }
  throw InputError("kind of a policy: found " + std::to_string(int(policy.kind)) +
                   ", expected one of lodestone_policy_kind");
}

EventSettings events_of(const lodestone_event_settings& events) {
  return {events.all_bodies, events.least_speed, events.least_impulse};
}

// A task of the engine, as a C function of its address and an index.
void do_task(const void* task, std::int64_t index) { (*static_cast<const TaskRef*>(task))(index); }

ManagerSettings settings_of(const lodestone_settings* given) {
  if (!given) return {};
  const lodestone_settings s = *given;
  ManagerSettings settings;
  settings.gravity = vec3(s.gravity);
  settings.seed = s.seed;
  settings.threads = s.threads;
  settings.full_substeps = s.full_substeps;
  settings.sleeping = s.sleeping;
  settings.sleep = {s.sleep_speed, s.sleep_time};
  if (const int model = enumerator<int>(s.model, 2, "model"); model > 0)
    settings.model = StatisticalModel(model - 1);
  settings.signature_timing =
      enumerator(s.signature_timing, SignatureTiming::in_background, "signature_timing");
  settings.policy = policy_of(s.policy);
  settings.audit_ms = s.audit_ms;
  settings.tables = tables(s.tables);
  if (s.signatures)
    settings.signatures = [s](const Shape& shape, const ContactLaw& law) {
      const lodestone_signature* found =
          s.signatures(s.signatures_context, shape.name.c_str(), law.restitution, law.friction);
      return found ? found->signature : nullptr;
    };
  settings.events = events_of(s.events);
  if (s.jobs)
    settings.jobs = [s](std::int64_t count, TaskRef task) { s.jobs(s.jobs_context, count, do_task, &task); };
  if (s.pair_filter)
    settings.pair_filter = [s](BodyId first, BodyId second) {
      return s.pair_filter(s.pair_filter_context, body(first), body(second));
    };
  return settings;
}

}  // namespace

lodestone_policy lodestone_default_policy(void) {
  const PolicySettings settings;
  const DistancePolicy distance;
  const ProjectedSizePolicy size;
  lodestone_policy policy{};
  policy.kind = LODESTONE_POLICY_DISTANCE;
  policy.full_within = distance.full_within, policy.support_within = distance.support_within;
  policy.full_above_px = size.full_above_px, policy.support_above_px = size.support_above_px;
  policy.budget = BudgetPolicy{}.budget_ms;
  policy.hysteresis = settings.hysteresis;
  policy.min_dwell_frames = settings.min_dwell_frames,
  policy.max_transitions_per_frame = settings.max_transitions_per_frame;
  policy.most_full = settings.most_full, policy.most_support = settings.most_support;
  policy.out_of_view_factor = settings.out_of_view_factor, policy.look_ahead_s = settings.look_ahead_s;
  policy.contact_groups_together = settings.contact_groups_together;
  return policy;
}

lodestone_settings lodestone_default_settings(void) {
  const ManagerSettings s;
  lodestone_settings settings{};
  settings.gravity = vec3(s.gravity);
  settings.seed = s.seed;
  settings.threads = s.threads;
  settings.full_substeps = s.full_substeps;
  settings.sleeping = s.sleeping;
  settings.sleep_speed = s.sleep.speed, settings.sleep_time = s.sleep.time;
  settings.tables = tables(s.tables);
  settings.policy = lodestone_default_policy();
  settings.audit_ms = s.audit_ms;
  settings.events = {s.events.all_bodies, s.events.least_speed, s.events.least_impulse};
  return settings;
}

lodestone_result lodestone_create(const lodestone_settings* settings, lodestone_manager** manager) {
  return make_handle(manager, [&] { return Manager(settings_of(settings)); });
}

lodestone_result lodestone_create_in(dxWorld* world, dxSpace* space, const lodestone_settings* settings,
                                     lodestone_manager** manager) {
  return make_handle(manager, [&] { return Manager(world, space, settings_of(settings)); });
}

void lodestone_destroy(lodestone_manager* manager) { delete manager; }

lodestone_result lodestone_set_policy(lodestone_manager* manager, const lodestone_policy* policy) {
  return guarded([&] { of(manager).set_policy(policy_of(need(policy, "policy"))); });
}

lodestone_viewpoint lodestone_default_viewpoint(lodestone_vec3 position) {
  const Viewpoint v;
  return {position, {0, 0, 0}, vec3(v.up), v.vertical_fov_rad, v.height_px, v.aspect};
}

lodestone_result lodestone_set_viewpoints(lodestone_manager* manager, const lodestone_viewpoint* given,
                                          size_t count) {
  return guarded([&] {
    std::vector<Viewpoint> viewpoints;
    for (const lodestone_viewpoint& v : list(given, count, "viewpoints")) {
      const Vec3 direction = vec3(v.direction);
      viewpoints.push_back({.position = vec3(v.position),
                            .direction = direction.isZero(0.0) ? std::nullopt : std::optional(direction),
                            .up = vec3(v.up),
                            .vertical_fov_rad = v.vertical_fov_rad,
                            .height_px = v.height_px,
                            .aspect = v.aspect});
    }
    of(manager).set_viewpoints(std::span<const Viewpoint>(viewpoints));
  });
}

lodestone_result lodestone_set_gravity(lodestone_manager* manager, lodestone_vec3 gravity) {
  return guarded([&] { of(manager).set_gravity(vec3(gravity)); });
}

lodestone_result lodestone_get_gravity(const lodestone_manager* manager, lodestone_vec3* gravity) {
  return guarded([&] { give(gravity, vec3(of(manager).gravity())); });
}

lodestone_result lodestone_set_full_substeps(lodestone_manager* manager, int32_t substeps) {
  return guarded([&] { of(manager).set_full_substeps(substeps); });
}

lodestone_result lodestone_set_threads(lodestone_manager* manager, int32_t threads) {
  return guarded([&] { of(manager).set_threads(threads); });
}

lodestone_result lodestone_set_event_settings(lodestone_manager* manager,
                                              const lodestone_event_settings* settings) {
  return guarded([&] { of(manager).set_events(events_of(need(settings, "settings"))); });
}
