#include "reference/ode/bodies_ode.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "reference/error.h"

namespace lodestone::ode {
namespace {

constexpr double kLimit = 1e8;
constexpr int kSlotBits = 20;  // a million bodies; the other twelve bits of an id are its slot's generation
constexpr std::uint32_t kSlotMask = (1u << kSlotBits) - 1;

bool within_limit(const Vec3& v) {  // false for NaN
  return std::abs(v.x()) <= kLimit && std::abs(v.y()) <= kLimit && std::abs(v.z()) <= kLimit;
}

std::string describe(const RigidState& s) {
  return fmt::format("position {} {} {}, orientation {} {} {} {}, velocity {} {} {}, angular velocity {} {} {}",
                     s.position.x(), s.position.y(), s.position.z(), s.orientation.w(), s.orientation.x(),
                     s.orientation.y(), s.orientation.z(), s.velocity.x(), s.velocity.y(), s.velocity.z(),
                     s.angular_velocity.x(), s.angular_velocity.y(), s.angular_velocity.z());
}

void check_state(const RigidState& state) {
  if (!is_sound(state))
    check_that(false, "a body's state is finite, below 1e8 in each part, its orientation of unit norm:", describe(state));
}

void check_definition(const OdeBodyDefinition& definition, const OdeSettings& settings) {
  check_that(definition.shape != nullptr, "a body has a shape");
  check_that(definition.mass > 0.0 && std::isfinite(definition.mass), "a body's mass is positive:",
             std::to_string(definition.mass));
  check_that(is_possible_inertia(definition.shape->inertia_per_mass), "a rigid body can have the inertia of shape",
             definition.shape->name);
  check_that(settings.max_contacts_per_pair > 0, "pairs have at least one contact");
  check_state(definition.state);
}

void set_mass(dBodyID body, double mass, const Mat3& inertia_per_mass) {
  const Mat3 inertia = mass * inertia_per_mass;
  dMass parameters;
  dMassSetParameters(&parameters, mass, 0, 0, 0, inertia(0, 0), inertia(1, 1), inertia(2, 2), inertia(0, 1),
                     inertia(0, 2), inertia(1, 2));
  dBodySetMass(body, &parameters);
}

void set_sleeping(dBodyID body, bool sleeps, double radius) {
  dBodySetAutoDisableFlag(body, sleeps);
  dBodySetAutoDisableLinearThreshold(body, 0.05);
  dBodySetAutoDisableAngularThreshold(body, 0.05 / radius);
  dBodySetAutoDisableTime(body, 0.5);
  dBodySetAutoDisableSteps(body, 0);
  dBodyEnable(body);  // starts the .5 s; else a new body at rest would sleep in its first step
}

std::vector<Piece> pieces_of(const OdeBodyDefinition& definition) {
  const Shape& shape = *definition.shape;
  const bool mesh = definition.geometry == OdeGeometry::trimesh && !shape.sphere_radius;
  if (definition.geometry == OdeGeometry::hull || (mesh && shape.convex)) return {{&shape}};
  std::vector<Piece> pieces;
  if (mesh)
    for (const Shape& piece : shape.pieces) pieces.push_back({&piece, piece.center_of_mass_in_mesh});
  return pieces;
}

double reach_of(const Shape& shape, std::span<const Sphere> spheres) {
  if (spheres.empty()) return shape.radius;
  double reach = 0.0;
  for (const Sphere& sphere : spheres) reach = std::max(reach, sphere.center.norm() + sphere.radius);
  return reach;
}

void destroy(dBodyID body) {
  while (const dGeomID geom = dBodyGetFirstGeom(body)) dGeomDestroy(geom);
  dBodyDestroy(body);
}

}  // namespace

bool is_sound(const RigidState& state) {
  return within_limit(state.position) && within_limit(state.velocity) && within_limit(state.angular_velocity) &&
         std::abs(state.orientation.squaredNorm() - 1.0) <= 1e-6;
}

RigidState state_of(dBodyID body) {
  return {to_vec3(dBodyGetPosition(body)), to_quat(dBodyGetQuaternion(body)), to_vec3(dBodyGetLinearVel(body)),
          to_vec3(dBodyGetAngularVel(body))};
}

void set_state(dBodyID body, const RigidState& state) {
  check_state(state);
  const Quat& q = state.orientation;
  const dQuaternion quaternion = {q.w(), q.x(), q.y(), q.z()};
  dBodySetPosition(body, state.position.x(), state.position.y(), state.position.z());
  dBodySetQuaternion(body, quaternion);
  // ODE normalizes what it is given, which can change the last bit; a body moved here from elsewhere keeps all of them.
  std::copy_n(quaternion, 4, const_cast<dReal*>(dBodyGetQuaternion(body)));
  dBodySetLinearVel(body, state.velocity.x(), state.velocity.y(), state.velocity.z());
  dBodySetAngularVel(body, state.angular_velocity.x(), state.angular_velocity.y(), state.angular_velocity.z());
}

Bodies::~Bodies() { clear(); }

void Bodies::clear() {
  for (const Body& body : slots_)
    if (body.body) destroy(body.body);
  slots_.clear();
  free_.clear();
  count_ = 0;
}

OdeBodyId Bodies::add(dWorldID world, dSpaceID space, const OdeBodyDefinition& definition, const OdeSettings& settings,
                      TrimeshCache& cache) {
  check_definition(definition, settings);
  const std::size_t slot = take_slot();
  Body& entry = slots_[slot];
  entry.id = {std::uint32_t(slot) | entry.generation << kSlotBits};
  entry.shape = definition.shape;
  entry.material = definition.material;
  entry.spheres = spheres_of(definition);
  entry.pieces = pieces_of(definition);
  entry.reach = reach_of(*entry.shape, entry.spheres);
  entry.thickness = entry.spheres.size() == 1 ? entry.spheres[0].radius : entry.shape->inner_radius;
  entry.last_good = definition.state;

  entry.body = dBodyCreate(world);
  dBodySetData(entry.body, reinterpret_cast<void*>(slot + 1));
  set_mass(entry.body, definition.mass, entry.shape->inertia_per_mass);
  dBodySetGyroscopicMode(entry.body, settings.gyroscopic);
  set_sleeping(entry.body, settings.auto_disable, entry.reach);
  make_geoms(space, entry.body, definition, entry.spheres, cache);
  set_state(entry.body, definition.state);
  ++count_, ++created_;
  return entry.id;
}

std::size_t Bodies::take_slot() {
  std::size_t slot = slots_.size();
  if (free_.empty()) {
    check_that(slot <= kSlotMask, "an OdeWorld holds at most 2^20 bodies");
    slots_.emplace_back();
  } else {
    slot = free_.back();
    free_.pop_back();
  }
  // Twelve bits, never zero: an id is never null.
  slots_[slot].generation = slots_[slot].generation % 0xfff + 1;
  return slot;
}

void Bodies::remove(OdeBodyId id) {
  Body& entry = find(id);
  destroy(entry.body);
  Body free_slot;
  free_slot.generation = entry.generation;
  entry = std::move(free_slot);
  free_.push_back(id.value & kSlotMask);
  --count_;
}

const Body& Bodies::find(OdeBodyId id) const {
  const std::size_t slot = id.value & kSlotMask;
  check_that(id && slot < slots_.size() && slots_[slot].body && slots_[slot].id == id, "the OdeBodyId is of a body in this world");
  return slots_[slot];
}

Body& Bodies::find(OdeBodyId id) { return const_cast<Body&>(std::as_const(*this).find(id)); }

Body* Bodies::owner(dBodyID body) {
  if (!body) return nullptr;
  const auto slot = reinterpret_cast<std::uintptr_t>(dBodyGetData(body)) - 1;
  return slot < slots_.size() && slots_[slot].body == body ? &slots_[slot] : nullptr;
}

}  // namespace lodestone::ode
