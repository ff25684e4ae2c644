// A manager, its settings, its ground and its steps.
#include <cstring>

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

// What a task is to C.
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

DrawSettings drawing_of(const lodestone_draw_settings* given) {
  if (!given) return {};
  const lodestone_draw_settings& s = *given;
  return {.bodies = s.bodies,
          .contacts = s.contacts,
          .bounds = s.bounds,
          .colors = {color(s.colors[0]), color(s.colors[1]), color(s.colors[2])},
          .contact_color = color(s.contact_color),
          .bounds_color = color(s.bounds_color),
          .normal_length = s.normal_length};
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

lodestone_result lodestone_add_material(lodestone_manager* manager, double restitution, double friction,
                                        double density, int32_t* material) {
  return guarded([&] {
    give(material, std::int32_t(of(manager).materials().add({restitution, friction, density})));
  });
}

lodestone_result lodestone_replace_material(lodestone_manager* manager, int32_t material, double restitution,
                                            double friction, double density) {
  return guarded([&] { of(manager).materials().replace(material, {restitution, friction, density}); });
}

lodestone_result lodestone_set_contact_law(lodestone_manager* manager, int32_t first, int32_t second,
                                           double restitution, double friction) {
  return guarded([&] { of(manager).materials().set_law(first, second, {restitution, friction}); });
}

lodestone_result lodestone_add_plane(lodestone_manager* manager, lodestone_vec3 normal, double offset,
                                     int32_t material, lodestone_ground* added) {
  return guarded([&] { give(added, ground(of(manager).add_plane(vec3(normal), offset, material))); });
}

lodestone_result lodestone_add_static_box(lodestone_manager* manager, lodestone_vec3 sides,
                                          lodestone_vec3 position, lodestone_quat orientation,
                                          int32_t material, lodestone_ground* added) {
  return guarded([&] {
    give(added, ground(of(manager).add_static_box(vec3(sides), vec3(position), quat(orientation), material)));
  });
}

lodestone_result lodestone_add_static_mesh(lodestone_manager* manager, const lodestone_vec3* vertices,
                                           size_t vertex_count, const int32_t* faces, size_t face_count,
                                           int32_t material, lodestone_ground* added) {
  return guarded([&] {
    give(added,
         ground(of(manager).add_static_mesh(mesh(vertices, vertex_count, faces, face_count), material)));
  });
}

lodestone_result lodestone_move_ground(lodestone_manager* manager, lodestone_ground id,
                                       const lodestone_state* to) {
  return guarded([&] { of(manager).move_ground(ground(id), state(need(to, "state"))); });
}

lodestone_result lodestone_remove_ground(lodestone_manager* manager, lodestone_ground id) {
  return guarded([&] { of(manager).remove_ground(ground(id)); });
}

lodestone_result lodestone_include_body(lodestone_manager* manager, dxBody* ode_body) {
  return guarded([&] { of(manager).include_body(ode_body); });
}

lodestone_result lodestone_exclude_body(lodestone_manager* manager, dxBody* ode_body) {
  return guarded([&] { of(manager).exclude_body(ode_body); });
}

bool lodestone_is_valid_ground(const lodestone_manager* manager, lodestone_ground id) {
  return manager && manager->manager.valid(ground(id));
}

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

// ---- Snapshots, recordings, hooks ----

lodestone_result lodestone_snapshot(const lodestone_manager* manager, void* buffer, size_t capacity,
                                    size_t* size) {
  return guarded([&] {
    const std::vector<std::byte> bytes = of(manager).snapshot();
    if (buffer && capacity < bytes.size())
      throw InputError("capacity: found " + std::to_string(capacity) + ", expected at least " +
                       std::to_string(bytes.size()));
    if (buffer) std::memcpy(buffer, bytes.data(), bytes.size());
    give(size, bytes.size());
  });
}

lodestone_result lodestone_restore(lodestone_manager* manager, const void* snapshot, size_t size,
                                   const lodestone_shape* const* given, size_t shape_count) {
  return guarded([&] {
    of(manager).restore(list(static_cast<const std::byte*>(snapshot), size, "snapshot"),
                        shapes(given, shape_count));
  });
}

lodestone_result lodestone_set_record(lodestone_manager* manager,
                                      void (*write)(void* context, const void* bytes, size_t size),
                                      void* context) {
  return guarded([&] {
    if (write)
      of(manager).set_record(
          [write, context](std::span<const std::byte> bytes) { write(context, bytes.data(), bytes.size()); });
    else
      of(manager).set_record({});
  });
}

lodestone_result lodestone_replay(lodestone_manager* manager, const void* recording, size_t size,
                                  const lodestone_shape* const* given, size_t shape_count,
                                  lodestone_replay_result* result) {
  return guarded([&] {
    const ReplayResult replayed = of(manager).replay(
        list(static_cast<const std::byte*>(recording), size, "recording"), shapes(given, shape_count));
    manager->replayed = replayed.text;
    give(result, lodestone_replay_result{replayed.steps, replayed.same, body(replayed.body),
                                         manager->replayed.c_str()});
  });
}

lodestone_result lodestone_set_log(lodestone_manager* manager,
                                   void (*log)(void* context, lodestone_log_level level, const char* text),
                                   void* context) {
  return guarded([&] {
    if (log)
      of(manager).set_log([log, context](LogLevel level, std::string_view text) {
        log(context, lodestone_log_level(level), std::string(text).c_str());
      });
    else
      of(manager).set_log({});
  });
}

lodestone_result lodestone_set_profile(lodestone_manager* manager,
                                       void (*begin)(void* context, const char* zone),
                                       void (*end)(void* context, const char* zone), void* context) {
  return guarded([&] {
    ProfileHooks hooks;
    if (begin)
      hooks.begin = [begin, context](std::string_view zone) {
        begin(context, zone.data());
      };  // names are literals
    if (end) hooks.end = [end, context](std::string_view zone) { end(context, zone.data()); };
    of(manager).set_profile(std::move(hooks));
  });
}

lodestone_draw_settings lodestone_default_draw_settings(void) {
  const DrawSettings s;
  return {s.bodies,
          s.contacts,
          s.bounds,
          {color(s.colors[0]), color(s.colors[1]), color(s.colors[2])},
          color(s.contact_color),
          color(s.bounds_color),
          s.normal_length};
}

lodestone_result lodestone_draw(const lodestone_manager* manager,
                                void (*line)(void* context, lodestone_vec3 from, lodestone_vec3 to,
                                             lodestone_color color),
                                void (*point)(void* context, lodestone_vec3 at, lodestone_color color),
                                void* context, const lodestone_draw_settings* settings) {
  return guarded([&] {
    DebugDrawer drawer;
    if (line)
      drawer.line = [&](const Vec3& from, const Vec3& to, DebugColor of_line) {
        line(context, vec3(from), vec3(to), color(of_line));
      };
    if (point)
      drawer.point = [&](const Vec3& at, DebugColor of_point) { point(context, vec3(at), color(of_point)); };
    of(manager).draw(drawer, drawing_of(settings));
  });
}
