#include "reference/ode/bodies_ode.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "reference/error.h"
#include "reference/mass_bounds.h"
#include "reference/ode/body_joints.h"

namespace lodestone::ode {
namespace {

constexpr double kLimit = 1e8;
constexpr int kSlotBits = 20;  // a million bodies; the other twelve bits of an id are its slot's generation
constexpr std::uint32_t kSlotMask = (1u << kSlotBits) - 1;

bool within_limit(const Vec3& v) {  // false for NaN
  return std::abs(v.x()) <= kLimit && std::abs(v.y()) <= kLimit && std::abs(v.z()) <= kLimit;
}

}  // namespace

std::string describe(const RigidState& s) {
  return fmt::format(
      "position {} {} {}, orientation {} {} {} {}, velocity {} {} {}, angular velocity {} {} {}",
      s.position.x(), s.position.y(), s.position.z(), s.orientation.w(), s.orientation.x(), s.orientation.y(),
      s.orientation.z(), s.velocity.x(), s.velocity.y(), s.velocity.z(), s.angular_velocity.x(),
      s.angular_velocity.y(), s.angular_velocity.z());
}

namespace {

void check_state(const RigidState& state) {
  if (!is_sound(state)) throw_input_error("a body's state", describe(state), kSound);
}

void check_properties(const BodyProperties& properties) {
  const bool rates = properties.linear_damping >= 0.0 && properties.angular_damping >= 0.0;
  if (!rates || !std::isfinite(properties.linear_damping) || !std::isfinite(properties.angular_damping))
    throw InputError(fmt::format("a body's damping: found {} and {} 1/s, expected finite, 0 or more",
                                 properties.linear_damping, properties.angular_damping));
  if (!(properties.max_angular_speed > 0.0))
    throw InputError(fmt::format("a body's greatest angular speed: found {} rad/s, expected more than 0",
                                 properties.max_angular_speed));
}

void check_definition(const OdeBodyDefinition& definition, const OdeSettings& settings) {
  check_that(settings.max_contacts_per_pair > 0, "pairs have at least one contact");
  if (!definition.shape) throw_input_error("a body's shape", "none", "one");
  check_mass(definition.mass);
  check_inertia(*definition.shape);
  check_properties(definition.properties);
  check_state(definition.state);
}

void set_mass(dBodyID body, double mass, const Mat3& inertia_per_mass) {
  const Mat3 inertia = mass * inertia_per_mass;
  dMass parameters;
  dMassSetParameters(&parameters, mass, 0, 0, 0, inertia(0, 0), inertia(1, 1), inertia(2, 2), inertia(0, 1),
                     inertia(0, 2), inertia(1, 2));
  dBodySetMass(body, &parameters);
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

void destroy(dBodyID body, dSpaceID space) {
  while (const dGeomID geom = dBodyGetFirstGeom(body)) {
    if (dGeomGetSpace(geom) == space)
      dGeomDestroy(geom);
    else
      dGeomSetBody(geom, nullptr);  // the caller's, who hung it there
  }
  dBodyDestroy(body);
}

}  // namespace

bool is_held(const Body& body) { return !body.held_force.isZero(0.0) || !body.held_torque.isZero(0.0); }

void set_force(dBodyID body, const Vec3& force, const Vec3& torque) {
  dBodySetForce(body, force.x(), force.y(), force.z());
  dBodySetTorque(body, torque.x(), torque.y(), torque.z());
}

bool is_sound(const RigidState& state) {
  return within_limit(state.position) && within_limit(state.velocity) &&
         within_limit(state.angular_velocity) && std::abs(state.orientation.squaredNorm() - 1.0) <= 1e-6;
}

std::uint32_t slot_of(OdeBodyId id) { return id.value & kSlotMask; }

void set_properties(Body& body, const BodyProperties& properties) {
  check_properties(properties);
  body.properties = properties;
  properties.kinematic ? dBodySetKinematic(body.body) : dBodySetDynamic(body.body);
  dBodySetGravityMode(body.body, properties.gravity);
  dBodySetMaxAngularSpeed(body.body, properties.kinematic ? dInfinity : properties.max_angular_speed);
  for (dGeomID geom = dBodyGetFirstGeom(body.body); geom; geom = dBodyGetNextGeom(geom)) {
    dGeomSetCategoryBits(geom, properties.category);
    dGeomSetCollideBits(geom, properties.collide);
  }
}

// ODE takes the same part of a velocity away in each of its steps, however long; of kinematic ones, too.
void set_damping(Body& body, double h) {
  const BodyProperties& properties = body.properties;
  const bool damps =
      !properties.kinematic && (properties.linear_damping > 0.0 || properties.angular_damping > 0.0);
  if (!damps && !body.damped) return;
  const double time = damps ? h : 0.0;
  dBodySetDamping(body.body, -std::expm1(-properties.linear_damping * time),
                  -std::expm1(-properties.angular_damping * time));
  body.damped = damps;
}

bool is_moving(dBodyID body) {
  if (!body || !dBodyIsEnabled(body)) return false;
  return !dBodyIsKinematic(body) || !to_vec3(dBodyGetLinearVel(body)).isZero(0.0) ||
         !to_vec3(dBodyGetAngularVel(body)).isZero(0.0);
}

RigidState state_of(dBodyID body) {
  return {to_vec3(dBodyGetPosition(body)), to_quat(dBodyGetQuaternion(body)),
          to_vec3(dBodyGetLinearVel(body)), to_vec3(dBodyGetAngularVel(body))};
}

void set_orientation(dBodyID body, const Quat& orientation) {
  const Quat& q = orientation;
  const dQuaternion quaternion = {q.w(), q.x(), q.y(), q.z()};
  dBodySetQuaternion(body, quaternion);
  // ODE normalizes what it is given, which can change the last bit; a body moved here from elsewhere keeps
  // all of them.
  std::copy_n(quaternion, 4, const_cast<dReal*>(dBodyGetQuaternion(body)));
}

void set_state(dBodyID body, const RigidState& state) {
  check_state(state);
  dBodySetPosition(body, state.position.x(), state.position.y(), state.position.z());
  set_orientation(body, state.orientation);
  dBodySetLinearVel(body, state.velocity.x(), state.velocity.y(), state.velocity.z());
  dBodySetAngularVel(body, state.angular_velocity.x(), state.angular_velocity.y(),
                     state.angular_velocity.z());
}

Bodies::~Bodies() { clear(); }

void Bodies::clear() {
  for (const Body& body : slots_)
    if (body.body) destroy(body.body, space_);
  slots_.clear();
  free_.clear();
  count_ = 0;
  births_ = 0;
  greatest_reach_ = 0.0;
}

OdeBodyId Bodies::add(dWorldID world, const OdeBodyDefinition& definition, const OdeSettings& settings,
                      TrimeshCache& cache) {
  check_definition(definition, settings);
  const std::size_t slot = take_slot();
  make(slot, world, definition, settings, cache);
  return slots_[slot].id;
}

void Bodies::make(std::size_t slot, dWorldID world, const OdeBodyDefinition& definition,
                  const OdeSettings& settings, TrimeshCache& cache) {
  Body& entry = slots_[slot];
  entry.id = {std::uint32_t(slot) | entry.generation << kSlotBits};
  entry.shape = definition.shape;
  entry.material = definition.material;
  entry.spheres = spheres_of(definition);
  entry.pieces = pieces_of(definition);
  entry.reach = reach_of(*entry.shape, entry.spheres);
  entry.thickness = entry.spheres.size() == 1 ? entry.spheres[0].radius : entry.shape->inner_radius;
  entry.last_good = definition.state;
  entry.geometry = definition.geometry;
  entry.birth = ++births_;

  entry.body = dBodyCreate(world);
  dBodySetData(entry.body, reinterpret_cast<void*>(slot + 1));
  set_mass(entry.body, definition.mass, entry.shape->inertia_per_mass);
  dBodySetGyroscopicMode(entry.body, settings.gyroscopic);
  // Whatever the caller's world gives its bodies: sleep is ours (sleep_ode.h), the rest is in the properties.
  dBodySetAutoDisableFlag(entry.body, 0);
  dBodySetDamping(entry.body, 0.0, 0.0);
  dBodySetLinearDampingThreshold(entry.body, 0.0);
  dBodySetAngularDampingThreshold(entry.body, 0.0);
  entry.to_sleep_s = settings.sleep.time;  // else a new body at rest would sleep in its first step
  make_geoms(space_, entry.body, definition, entry.spheres, cache);
  set_properties(entry, definition.properties);
  set_state(entry.body, definition.state);
  greatest_reach_ = std::max(greatest_reach_, entry.reach);
  ++count_, ++created_;
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
  destroy(entry.body, space_);
  Body free_slot;
  free_slot.generation = entry.generation;
  entry = std::move(free_slot);
  free_.push_back(id.value & kSlotMask);
  --count_;
}

const Body& Bodies::find(OdeBodyId id) const {
  const std::size_t slot = id.value & kSlotMask;
  if (!(id && slot < slots_.size() && slots_[slot].body && slots_[slot].id == id))
    throw InputError(fmt::format(
        "OdeBodyId {}: found no such body, expected one of this world that was not removed", id.value));
  return slots_[slot];
}

Body& Bodies::find(OdeBodyId id) { return const_cast<Body&>(std::as_const(*this).find(id)); }

Body* Bodies::owner(dBodyID body) {
  if (!body) return nullptr;
  const auto slot = reinterpret_cast<std::uintptr_t>(dBodyGetData(body)) - 1;
  return slot < slots_.size() && slots_[slot].body == body ? &slots_[slot] : nullptr;
}

void wake_jointed(Bodies& bodies, const Body& body) {
  for (const dBodyID joined : find_jointed_group(body.body)) {
    dBodyEnable(joined);
    if (Body* const own = bodies.owner(joined)) own->disturbed = true;
  }
}

}  // namespace lodestone::ode
