// Of Collision: planes, static boxes and meshes, how they come and go, and how they move in a step.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "reference/error.h"
#include "reference/ode/collision_ode.h"
#include "reference/ode/exact_solid.h"
#include "reference/state_archive.h"

namespace lodestone::ode {
namespace {

void place(dGeomID geom, const RigidState& state) {
  dGeomSetPosition(geom, state.position.x(), state.position.y(), state.position.z());
  const dQuaternion q = {state.orientation.w(), state.orientation.x(), state.orientation.y(),
                         state.orientation.z()};
  dGeomSetQuaternion(geom, q);
}

RigidState moved_on(RigidState state, double time) {
  state.position += state.velocity * time;
  state.orientation = (rotation_from_vector(state.angular_velocity * time) * state.orientation).normalized();
  return state;
}

/// Longer, too, than bodies may be.
Shape box_of_any_size(const Vec3& sides) {
  constexpr double kLongest = 1e4;  // m
  const double longest = sides.maxCoeff();
  const auto make = [](const Vec3& s) { return make_shape("static box", make_box(s)); };
  return longest <= kLongest ? make(sides)
                             : scale_shape(make(sides * (kLongest / longest)), longest / kLongest);
}

}  // namespace

OdeGroundId Collision::add_plane(const Vec3& normal, double offset, MaterialId material) {
  if (!(std::abs(normal.norm() - 1.0) < 1e-6 && std::isfinite(offset)))
    throw InputError(fmt::format(
        "a plane: found the normal ({}, {}, {}) and the offset {} m, expected a normal of unit length and a "
        "finite offset",
        normal.x(), normal.y(), normal.z(), offset));
  planes_.push_back({normal,
                     offset,
                     material,
                     dCreatePlane(nullptr, normal.x(), normal.y(), normal.z(), offset),
                     ~0u,
                     ~0u,
                     {++last_ground_id_}});
  return planes_.back().id;
}

OdeGroundId Collision::add_box(const Vec3& sides, const Vec3& position, const Quat& orientation,
                               MaterialId material) {
  const RigidState state{position, orientation, Vec3::Zero(), Vec3::Zero()};
  if (!(sides.allFinite() && sides.minCoeff() > 0.0 && is_sound(state)))
    throw InputError(fmt::format(
        "a static box: found sides of {}, {} and {} m and {}, expected positive sides and a pose that is {}",
        sides.x(), sides.y(), sides.z(), describe(state), kSound));
  constexpr double kSheet = 1e-3;  // of the longest side: what is thinner may be no solid, which is known now
  Ground ground{.material = material, .put = state, .state = state};
  if (sides.minCoeff() < kSheet * sides.maxCoeff())
    ground.solid = box_of(sides);
  else
    ground.sides = sides;
  ground.geom = dCreateBox(nullptr, sides.x(), sides.y(), sides.z());
  place(ground.geom, state);
  return add_ground(std::move(ground));
}

// Boxes alike share theirs.
std::shared_ptr<const Shape> Collision::box_of(const Vec3& sides) {
  std::weak_ptr<const Shape>& known = ground_boxes_[{sides.x(), sides.y(), sides.z()}];
  std::shared_ptr<const Shape> box = known.lock();
  if (!box) known = box = std::make_shared<const Shape>(box_of_any_size(sides));
  return box;
}

// That of a box is made once something comes near: a level has thousands, and each takes .2 ms.
const Shape* Collision::solid_of(Ground& ground) {
  if (ground.sides) ground.solid = box_of(*std::exchange(ground.sides, {}));
  return ground.solid.get();
}

OdeGroundId Collision::add_mesh(const Mesh& mesh, MaterialId material) {
  auto data = std::make_unique<TrimeshData>(mesh.vertices, mesh.faces);
  const dGeomID geom = dCreateTriMesh(nullptr, data->id(), nullptr, nullptr, nullptr);
  ++ground_meshes_;
  return add_ground({.geom = geom,
                     .material = material,
                     .solid = find_exact_solid("static mesh", mesh),
                     .mesh = std::move(data)});
}

OdeGroundId Collision::add_ground(Ground ground) {
  std::size_t number = ground_.size();
  if (free_ground_.empty()) {
    ground_.emplace_back();
  } else {
    number = free_ground_.back();
    free_ground_.pop_back();
  }
  ground.id = {++last_ground_id_}, ground.before = ground.put;
  dGeomSetData(ground.geom, reinterpret_cast<void*>(number));
  broad_phase_.add_ground(ground.geom);
  number_of_[ground.id.value] = number;
  ground_[number] = std::move(ground);
  return ground_[number].id;
}

Ground& Collision::find_ground(OdeGroundId id) {
  const auto found = number_of_.find(id.value);
  if (found == number_of_.end())
    throw InputError(
        fmt::format("OdeGroundId {}: found no such box or mesh, expected one of this world", id.value));
  return ground_[found->second];
}

void Collision::move_ground(OdeGroundId id, const RigidState& state, Bodies& bodies) {
  Ground& ground = find_ground(id);
  if (!is_sound(state)) throw_input_error("a pose of ground", describe(state), kSound);
  const Eigen::AlignedBox3d before = bounds_of(ground.geom);
  put(ground, ground.put = state);
  ground.moved = true;
  ground.moves = !state.velocity.isZero(0.0) || !state.angular_velocity.isZero(0.0);
  broad_phase_.wake_ours(bodies, before);
  broad_phase_.wake_ours(bodies, bounds_of(ground.geom));
}

void Collision::remove_ground(OdeGroundId id, Bodies& bodies) {
  if (const auto plane = std::ranges::find(planes_, id, &Plane::id); id && plane != planes_.end()) {
    for (Body& body : bodies.slots())
      if (body.body &&
          plane->normal.dot(to_vec3(dBodyGetPosition(body.body))) - plane->offset < 1.1 * body.reach)
        wake_jointed(bodies, body);
    dGeomDestroy(plane->geom);
    planes_.erase(plane);
    return;
  }
  Ground& ground = find_ground(id);
  broad_phase_.wake_ours(bodies, bounds_of(ground.geom));
  broad_phase_.remove_ground(ground.geom);
  dGeomDestroy(ground.geom);
  free_ground_.push_back(std::uint32_t(&ground - ground_.data()));
  number_of_.erase(id.value);
  ground = {};
}

void Collision::put(Ground& ground, const RigidState& state) {
  const Eigen::AlignedBox3d before = bounds_of(ground.geom);
  place(ground.geom, state);
  ground.state = state;
  broad_phase_.follow_ground(ground.geom, before);
}

void Collision::begin_step(Bodies& bodies, double dt) {
  for (Ground& ground : ground_) {
    if (ground.moved || gone_ == 0.0) ground.goes = ground.moved;
    if (!ground.id || !ground.moves || !ground.goes) continue;
    const Eigen::AlignedBox3d before = bounds_of(ground.geom);
    put(ground, moved_on(ground.put, gone_ + dt));
    broad_phase_.wake_ours(bodies, before.merged(bounds_of(ground.geom)));
    put_after(ground, 0.0);
  }
}

void Collision::move_on(double after) {
  for (Ground& ground : ground_)
    if (ground.id && ground.moves) put_after(ground, after);
}

// `after`: s, from the beginning of this step, or of this part of one.
void Collision::put_after(Ground& ground, double after) {
  const double way = (ground.goes ? gone_ : 0.0) + after;
  put(ground, way > 0.0 ? moved_on(ground.put, way) : ground.put);
}

void Collision::go_on(double gone) {
  gone_ = gone;
  move_on(0.0);
}

void Collision::end_step() {
  for (Ground& ground : ground_)
    ground.last_way = ground.way(), ground.before = ground.put, ground.moved = false;
}

double Ground::way() const {
  if (!id || !moved) return 0.0;
  const double rim = 0.5 * bounds_of(geom).diagonal().norm();
  return (put.position - before.position).norm() + before.orientation.angularDistance(put.orientation) * rim;
}

// For a reader who has the same ground.
void Collision::archive(StateArchive& a) {
  struct Course {
    RigidState before;
    double last_way;
    bool moved;
  };
  std::vector<Course> courses;
  for (const Ground& ground : ground_) courses.push_back({ground.before, ground.last_way, ground.moved});
  a(courses);
  if (!a.reading()) return;
  for (std::size_t i = 0; i < std::min(courses.size(), ground_.size()); ++i)
    ground_[i].before = courses[i].before, ground_[i].last_way = courses[i].last_way,
    ground_[i].moved = courses[i].moved;
}

}  // namespace lodestone::ode
