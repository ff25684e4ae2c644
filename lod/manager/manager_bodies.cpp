#include <fmt/format.h>

#include "lod/manager/crowded_places.h"
#include "lod/manager/manager_impl.h"
#include "lod/manager/transfer.h"
#include "reference/error.h"

namespace lodestone {

BodyId Manager::add_body(const BodyDefinition& definition) {
  Levels& levels = impl_->levels;
  const double mass = checked_mass(definition, levels.materials);
  check_properties(definition.properties);
  BodyDefinition sound = definition;
  sound.state = checked(definition.state);
  impl_->changes.keep_moved();
  const BodyId body = levels.bodies.add(sound, mass);
  impl_->changes.add(body.index);
  impl_->left_places.note_place(impl_->levels, body);
  impl_->queries.touch();
  if (definition.events) impl_->events.ask(body.index, true);
  if (definition.level == LevelChoice::full &&
      !is_full_place(levels, sound.state.position, *definition.shape)) {
    place(levels, body.index, Rung::full);
    levels.bodies.forget_last_newcomer();
  }
  impl_->recorder.note(Call::add_body, name_of(*definition.shape), definition.state, definition.material,
                       definition.mass, definition.level, definition.importance, definition.properties,
                       definition.user_data, definition.events, definition.least_rung,
                       definition.greatest_rung);
  return body;
}

void Manager::remove_body(BodyId body) {
  const std::uint32_t index = impl_->index_of(body);
  impl_->changes.keep_moved();
  take_out(impl_->levels, index);
  impl_->events.forget(body.index);
  impl_->queries.forget(body.index);
  impl_->levels.bodies.remove(body);
  impl_->levels.put_off.forget(body.index);
  impl_->choose.forget(body.index);
  impl_->recorder.note(Call::remove_body, body);
}

void Manager::set_level(BodyId body, LevelChoice choice) {
  BodyTable& bodies = impl_->levels.bodies;
  const std::uint32_t index = bodies.index_of(body);
  check_level_choice(choice);
  bodies.set_choice(index, choice);
  impl_->choose.note(body.index);
  impl_->recorder.note(Call::set_level, body, choice);
}

void Manager::set_importance(BodyId body, double importance) {
  const std::uint32_t index = impl_->index_of(body);
  check_positive(importance, "importance");
  impl_->levels.bodies.set_importance(index, importance);
  impl_->choose.note(index);
  impl_->recorder.note(Call::set_importance, body, importance);
}

void Manager::set_user_data(BodyId body, std::uintptr_t user_data) {
  impl_->levels.bodies[impl_->index_of(body)].user_data = user_data;
  impl_->recorder.note(Call::set_user_data, body, user_data);
}

void Manager::set_properties(BodyId body, const BodyProperties& properties) {
  const std::uint32_t index = impl_->index_of(body);
  check_properties(properties);
  impl_->changes.keep_moved();
  Levels& levels = impl_->levels;
  const BodyProperties before = levels.bodies.properties(index);
  const bool shows_to_others = before.category != properties.category ||
                               before.collide != properties.collide ||
                               before.kinematic != properties.kinematic;
  levels.bodies.set_properties(index, properties);
  if (levels.bodies[index].statistical && levels.bodies.level(index).rung == Rung::tables &&
      levels.bodies.level(index).own_properties)
    transfer(levels, index, Rung::support);
  if (levels.bodies[index].ode) levels.full.world()->set_properties(levels.bodies[index].ode, properties);
  if (shows_to_others)
    levels.set_state(index, levels.state(index));
  else
    levels.set_motion(index, levels.state(index));
  impl_->choose.note(index);
  impl_->recorder.note(Call::set_properties, body, properties);
}

void Manager::set_state(BodyId body, const RigidState& state) {
  const std::uint32_t index = impl_->index_of(body);
  const RigidState sound = checked(state);
  impl_->changes.keep_moved();
  impl_->levels.set_state(index, sound);
  impl_->choose.groups().note_put(index);
  impl_->queries.touch();
  impl_->choose.note(index);
  impl_->recorder.note(Call::set_state, body, state);
}

void Manager::add_force(BodyId body, const Vec3& force, const Vec3& torque) {
  const std::uint32_t index = impl_->index_of(body);
  check_finite(force, "force");
  check_finite(torque, "torque");
  impl_->changes.keep_moved();
  impl_->levels.bodies.add_force(index, {force, torque});
  impl_->levels.wake(index);
  impl_->recorder.note(Call::add_force, body, force, torque);
}

void Manager::add_force_at(BodyId body, const Vec3& force, const Vec3& point) {
  check_finite(point, "point of a force");
  add_force(body, force, (point - state(body).position).cross(force));
}

void Manager::add_impulse(BodyId body, const Vec3& impulse, const Vec3& point) {
  const std::uint32_t index = impl_->index_of(body);
  check_finite(impulse, "impulse");
  check_finite(point, "point of an impulse");
  impl_->changes.keep_moved();
  Levels& levels = impl_->levels;
  RigidState state = levels.state(index);
  if (levels.bodies.properties(index).kinematic) {
    levels.wake(index);
    return impl_->recorder.note(Call::add_impulse, body, impulse, point);
  }
  const double mass = levels.bodies[index].mass;
  const Vec3 angular = state.orientation.conjugate() * (point - state.position).cross(impulse);
  state.velocity += impulse / mass;
  state.angular_velocity +=
      state.orientation * (levels.bodies.shape(index)->inverse_inertia_per_mass * angular) / mass;
  levels.set_motion(index, checked(state));
  impl_->recorder.note(Call::add_impulse, body, impulse, point);
}

void Manager::sleep(BodyId body) {
  const std::uint32_t index = impl_->index_of(body);
  impl_->changes.keep_moved();
  impl_->levels.put_to_sleep(index);
  impl_->choose.groups().note_put(index);
  impl_->changes.note(index);
  impl_->left_places.lay(impl_->levels, body);
  impl_->queries.lay_down(index);
  impl_->recorder.note(Call::sleep, body);
}

void Manager::wake(BodyId body) {
  const std::uint32_t index = impl_->index_of(body);
  impl_->changes.keep_moved();
  impl_->levels.wake(index);
  impl_->recorder.note(Call::wake, body);
}

}  // namespace lodestone
