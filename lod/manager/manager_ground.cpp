#include <fmt/format.h>

#include <cmath>

#include "lod/manager/manager_impl.h"
#include "reference/error.h"

namespace lodestone {
namespace {

void check_valid(const Ground& ground, GroundId id) {
  if (!ground.valid(id))
    throw_input_error("ground", fmt::format("the id {{{}, {}}}", id.index, id.generation),
                      "that of ground of this manager which was not removed");
}

void check_callers(const dxWorld* callers_world, const dxBody* body) {
  if (!callers_world) throw_input_error("world", "the manager's own", "the caller's");
  if (!body) throw_input_error("body", "a null one", "the caller's own");
}

}  // namespace

MaterialTable& Manager::materials() { return impl_->levels.materials; }

GroundId Manager::add_plane(const Vec3& normal, double offset, MaterialId material) {
  const Vec3 unit = checked_normal(normal, "normal of a plane");
  if (!std::isfinite(offset))
    throw_input_error("offset of a plane", fmt::format("{:g} m", offset), "a finite number");
  impl_->levels.materials.check_known(material);
  const HalfSpace plane{unit, offset, material};
  impl_->changes.keep_moved();
  const GroundId id = impl_->levels.ground.add_plane(plane);
  impl_->levels.full.add_plane(id, plane);
  impl_->levels.wake_on(plane);
  impl_->queries.touch();
  impl_->recorder.note(Call::add_plane, normal, offset, material);
  return id;
}

GroundId Manager::add_static_mesh(const Mesh& mesh, MaterialId material) {
  check_ground_mesh(mesh);
  impl_->levels.materials.check_known(material);
  impl_->changes.keep_moved();
  const GroundId id = impl_->levels.ground.add_mesh(mesh, material);
  impl_->levels.full.add_static_mesh(id, mesh, material);
  impl_->levels.wake_all_in(impl_->levels.ground.bounds(id));
  impl_->queries.touch();
  impl_->recorder.note(Call::add_static_mesh, mesh.vertices, mesh.faces, material);
  return id;
}

GroundId Manager::add_static_box(const Vec3& sides, const Vec3& position, const Quat& orientation,
                                 MaterialId material) {
  check_box_sides(sides);
  const RigidState pose = checked(RigidState{position, orientation, Vec3::Zero(), Vec3::Zero()});
  impl_->levels.materials.check_known(material);
  impl_->changes.keep_moved();
  const GroundId id = impl_->levels.ground.add_box(sides, position, pose.orientation, material);
  impl_->levels.full.add_static_box(id, sides, position, pose.orientation, material);
  impl_->levels.wake_all_in(impl_->levels.ground.bounds(id));
  impl_->queries.touch();
  impl_->recorder.note(Call::add_static_box, sides, position, orientation, material);
  return id;
}

namespace {

bool stands_so(const GroundPart& part, const RigidState& state) {
  return !part.moves() && state.velocity.isZero(0.0) && state.angular_velocity.isZero(0.0) &&
         part.pose.position == state.position && part.pose.orientation.coeffs() == state.orientation.coeffs();
}

}  // namespace

void Manager::move_ground(GroundId id, const RigidState& state) {
  Levels& levels = impl_->levels;
  check_valid(levels.ground, id);
  if (levels.ground.is_plane(id)) throw_input_error("ground to be moved", "a plane", "a static box or mesh");
  const RigidState sound = checked(state);
  if (stands_so(levels.ground.part(id), sound)) return;
  impl_->changes.keep_moved();
  const Eigen::AlignedBox3d before = levels.ground.bounds(id);
  levels.ground.move_part(id, {.position = sound.position,
                               .orientation = sound.orientation,
                               .velocity = sound.velocity,
                               .angular_velocity = sound.angular_velocity,
                               .comes_back = true});
  const Eigen::AlignedBox3d after = levels.ground.bounds(id);
  if (levels.ground.part(id).moves() && before.intersects(after))
    levels.wake_in(before);
  else
    levels.wake_piled_in(before);
  levels.wake_in(after);
  levels.full.move_ground(id, sound);
  impl_->queries.touch();
  impl_->recorder.note(Call::move_ground, id, state);
}

void Manager::remove_ground(GroundId id) {
  Levels& levels = impl_->levels;
  check_valid(levels.ground, id);
  impl_->changes.keep_moved();
  if (levels.ground.is_plane(id))
    levels.wake_all();
  else
    levels.wake_piled_in(levels.ground.bounds(id));
  levels.ground.remove(id);
  levels.full.remove_ground(id);
  impl_->queries.touch();
  impl_->recorder.note(Call::remove_ground, id);
}

bool Manager::valid(GroundId id) const { return impl_->levels.ground.valid(id); }

void Manager::include_body(dxBody* body) {
  check_callers(impl_->callers_world, body);
  impl_->levels.full.world()->include_body(body);
}

void Manager::exclude_body(dxBody* body) {
  check_callers(impl_->callers_world, body);
  impl_->levels.full.world()->exclude_body(body);
}

}  // namespace lodestone
