// Bodies: one by one, and many at once.
#include <cstring>

#include "lod/c_interface/c_values.h"

using namespace lodestone;
using namespace lodestone::c;

// The rules have the same numbers, and lists of ids are handed over as they are.
static_assert(int(Rule::paused) == LODESTONE_RULE_PAUSED &&
              int(Rule::overlap_put_off) == LODESTONE_RULE_OVERLAP_PUT_OFF &&
              int(Rule::dwell) == LODESTONE_RULE_DWELL);
static_assert(sizeof(BodyId) == sizeof(lodestone_body) && alignof(BodyId) == alignof(lodestone_body) &&
              offsetof(BodyId, generation) == offsetof(lodestone_body, generation));

namespace {

std::span<const BodyId> ids(const lodestone_body* bodies, std::size_t count) {
  return list(reinterpret_cast<const BodyId*>(bodies), count, "bodies");
}

Rung rung_of(lodestone_rung rung) { return enumerator(rung, Rung::full, "rung"); }
LevelChoice choice_of(lodestone_level_choice choice) {
  return enumerator(choice, LevelChoice::tables, "level");
}

lodestone_result give_list(std::span<const BodyId> (Manager::*which)() const,
                           const lodestone_manager* manager, const lodestone_body** bodies, size_t* count) {
  return guarded([&] {
    const std::span<const BodyId> found = (of(manager).*which)();
    give(bodies, reinterpret_cast<const lodestone_body*>(found.data()));
    give(count, found.size());
  });
}

}  // namespace

lodestone_properties lodestone_default_properties(void) { return properties(BodyProperties{}); }

lodestone_body_definition lodestone_default_body(const lodestone_shape* shape) {
  const BodyDefinition d;
  return {shape,
          state(d.state),
          d.material,
          0.0,
          LODESTONE_CHOOSE_AUTOMATIC,
          lodestone_rung(d.least_rung),
          lodestone_rung(d.greatest_rung),
          d.importance,
          properties(d.properties),
          d.user_data,
          d.events};
}

lodestone_result lodestone_add_body(lodestone_manager* manager, const lodestone_body_definition* definition,
                                    lodestone_body* added) {
  return guarded([&] {
    const lodestone_body_definition& d = need(definition, "definition");
    BodyDefinition body_definition{.shape = need(d.shape, "shape").shape,
                                   .state = state(d.state),
                                   .material = d.material,
                                   .level = choice_of(d.level),
                                   .importance = d.importance,
                                   .properties = properties(d.properties),
                                   .user_data = d.user_data,
                                   .events = d.events};
    body_definition.least_rung = rung_of(d.least_rung),
    body_definition.greatest_rung = rung_of(d.greatest_rung);
    if (d.mass != 0.0) body_definition.mass = d.mass;
    give(added, body(of(manager).add_body(body_definition)));
  });
}

lodestone_result lodestone_remove_body(lodestone_manager* manager, lodestone_body id) {
  return guarded([&] { of(manager).remove_body(body(id)); });
}

bool lodestone_is_valid(const lodestone_manager* manager, lodestone_body id) {
  return manager && manager->manager.valid(body(id));
}

lodestone_result lodestone_set_level(lodestone_manager* manager, lodestone_body id,
                                     lodestone_level_choice choice) {
  return guarded([&] { of(manager).set_level(body(id), choice_of(choice)); });
}

lodestone_result lodestone_set_rung_range(lodestone_manager* manager, lodestone_body id, lodestone_rung least,
                                          lodestone_rung greatest) {
  return guarded([&] { of(manager).set_rung_range(body(id), ::rung_of(least), ::rung_of(greatest)); });
}

lodestone_result lodestone_make_group(lodestone_manager* manager, const lodestone_body* bodies, size_t count,
                                      void (*before_demotion)(void* context, lodestone_group group),
                                      void (*after_promotion)(void* context, lodestone_group group),
                                      void* context, lodestone_group* group) {
  return guarded([&] {
    GroupJoints joints;
    if (before_demotion)
      joints.before_demotion = [=](GroupId id) { before_demotion(context, {id.index, id.generation}); };
    if (after_promotion)
      joints.after_promotion = [=](GroupId id) { after_promotion(context, {id.index, id.generation}); };
    const GroupId made = of(manager).make_group(ids(bodies, count), std::move(joints));
    give(group, lodestone_group{made.index, made.generation});
  });
}

lodestone_result lodestone_dissolve_group(lodestone_manager* manager, lodestone_group group) {
  return guarded([&] { of(manager).dissolve_group({group.index, group.generation}); });
}

bool lodestone_is_valid_group(const lodestone_manager* manager, lodestone_group group) {
  return manager && manager->manager.valid(GroupId{group.index, group.generation});
}

lodestone_result lodestone_explain(const lodestone_manager* manager, lodestone_body id,
                                   lodestone_reason* reason) {
  return guarded([&] {
    const Why why = of(manager).explain(body(id));
    give(reason, lodestone_reason{lodestone_rung(why.rung),
                                  lodestone_rule(why.rule),
                                  why.placed,
                                  why.in_view,
                                  why.distance_m,
                                  why.pixels,
                                  why.predicted_error,
                                  why.predicted_error_pixels,
                                  why.cost_work,
                                  why.cost_ms,
                                  why.dwell_left_frames,
                                  {why.group.index, why.group.generation}});
  });
}

lodestone_result lodestone_set_importance(lodestone_manager* manager, lodestone_body id, double importance) {
  return guarded([&] { of(manager).set_importance(body(id), importance); });
}

lodestone_result lodestone_set_state(lodestone_manager* manager, lodestone_body id,
                                     const lodestone_state* to) {
  return guarded([&] { of(manager).set_state(body(id), state(need(to, "state"))); });
}

lodestone_result lodestone_set_user_data(lodestone_manager* manager, lodestone_body id, uintptr_t user_data) {
  return guarded([&] { of(manager).set_user_data(body(id), user_data); });
}

lodestone_result lodestone_set_events(lodestone_manager* manager, lodestone_body id, bool events) {
  return guarded([&] { of(manager).set_events(body(id), events); });
}

lodestone_result lodestone_set_properties(lodestone_manager* manager, lodestone_body id,
                                          const lodestone_properties* to) {
  return guarded([&] { of(manager).set_properties(body(id), properties(need(to, "properties"))); });
}

lodestone_result lodestone_add_force(lodestone_manager* manager, lodestone_body id, lodestone_vec3 force,
                                     lodestone_vec3 torque) {
  return guarded([&] { of(manager).add_force(body(id), vec3(force), vec3(torque)); });
}

lodestone_result lodestone_add_force_at(lodestone_manager* manager, lodestone_body id, lodestone_vec3 force,
                                        lodestone_vec3 point) {
  return guarded([&] { of(manager).add_force_at(body(id), vec3(force), vec3(point)); });
}

lodestone_result lodestone_add_impulse(lodestone_manager* manager, lodestone_body id, lodestone_vec3 impulse,
                                       lodestone_vec3 point) {
  return guarded([&] { of(manager).add_impulse(body(id), vec3(impulse), vec3(point)); });
}

lodestone_result lodestone_sleep(lodestone_manager* manager, lodestone_body id) {
  return guarded([&] { of(manager).sleep(body(id)); });
}

lodestone_result lodestone_wake(lodestone_manager* manager, lodestone_body id) {
  return guarded([&] { of(manager).wake(body(id)); });
}

lodestone_result lodestone_get_state(const lodestone_manager* manager, lodestone_body id,
                                     lodestone_state* to) {
  return guarded([&] { give(to, state(of(manager).state(body(id)))); });
}

lodestone_result lodestone_get_mass(const lodestone_manager* manager, lodestone_body id, double* mass) {
  return guarded([&] { give(mass, of(manager).mass(body(id))); });
}

lodestone_result lodestone_get_user_data(const lodestone_manager* manager, lodestone_body id,
                                         uintptr_t* user_data) {
  return guarded([&] { give(user_data, of(manager).user_data(body(id))); });
}

lodestone_result lodestone_get_properties(const lodestone_manager* manager, lodestone_body id,
                                          lodestone_properties* to) {
  return guarded([&] { give(to, properties(of(manager).properties(body(id)))); });
}

lodestone_result lodestone_get_rung(const lodestone_manager* manager, lodestone_body id,
                                    lodestone_rung* rung) {
  return guarded([&] { give(rung, lodestone_rung(of(manager).rung(body(id)))); });
}

lodestone_result lodestone_is_asleep(const lodestone_manager* manager, lodestone_body id, bool* asleep) {
  return guarded([&] { give(asleep, of(manager).asleep(body(id))); });
}

lodestone_result lodestone_get_collision_radius(const lodestone_manager* manager, lodestone_body id,
                                                double* radius) {
  return guarded([&] { give(radius, of(manager).collision_radius(body(id))); });
}

lodestone_result lodestone_get_ode_body(const lodestone_manager* manager, lodestone_body id,
                                        dxBody** ode_body) {
  return guarded([&] { give(ode_body, of(manager).ode_body(body(id))); });
}

lodestone_result lodestone_why(const lodestone_manager* manager, lodestone_body id, char* text, size_t size,
                               size_t* length) {
  return guarded([&] {
    const std::string why = of(manager).why(body(id));
    if (size > 0) {
      const std::size_t kept = std::min(why.size(), size - 1);
      std::memcpy(&need(text, "text"), why.data(), kept);
      text[kept] = '\0';
    }
    give(length, why.size());
  });
}

lodestone_result lodestone_read_states(const lodestone_manager* manager, const lodestone_body* bodies,
                                       size_t count, lodestone_state* states) {
  return guarded([&] {
    const std::span<lodestone_state> to = list(states, count, "states");
    std::vector<RigidState> read(count);
    of(manager).read_states(ids(bodies, count), read);
    for (std::size_t i = 0; i < count; ++i) to[i] = state(read[i]);
  });
}

lodestone_result lodestone_read_poses(const lodestone_manager* manager, const lodestone_body* bodies,
                                      size_t count, float* positions_xyz, float* orientations_wxyz) {
  return guarded([&] {
    of(manager).read_poses(ids(bodies, count), list(positions_xyz, 3 * count, "positions"),
                           list(orientations_wxyz, 4 * count, "orientations"));
  });
}

lodestone_result lodestone_moved(const lodestone_manager* manager, const lodestone_body** bodies,
                                 size_t* count) {
  return give_list(&Manager::moved, manager, bodies, count);
}
lodestone_result lodestone_fell_asleep(const lodestone_manager* manager, const lodestone_body** bodies,
                                       size_t* count) {
  return give_list(&Manager::fell_asleep, manager, bodies, count);
}
lodestone_result lodestone_woke(const lodestone_manager* manager, const lodestone_body** bodies,
                                size_t* count) {
  return give_list(&Manager::woke, manager, bodies, count);
}
