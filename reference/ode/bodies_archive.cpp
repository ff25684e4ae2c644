// The bodies of an OdeWorld as bytes, and back to the bit: what ODE keeps of each and what is kept beside it.
#include <algorithm>

#include "reference/error.h"
#include "reference/ode/bodies_ode.h"
#include "reference/ode/geometry_ode.h"
#include "reference/state_archive.h"

namespace lodestone::ode {
namespace {

// What a body is made of, for when it is not there.
struct Making {
  std::shared_ptr<const Shape> shape;
  std::vector<Sphere> spheres;
  double mass = 0.0;
  MaterialId material = 0;
  OdeGeometry geometry = OdeGeometry::trimesh;
  BodyProperties properties = {};
  void archive(StateArchive& a) { a(shape, spheres, mass, material, geometry, properties); }
};

// What changes as it moves. The rotation matrix is the quaternion's to rounding only.
struct Motion {
  RigidState state, last_good;
  std::array<dReal, 12> rotation{};
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero(), given_force = Vec3::Zero(), given_torque = Vec3::Zero(),
       held_force = Vec3::Zero(), held_torque = Vec3::Zero(), withheld = Vec3::Zero();
  double to_sleep_s = 0.0;
  std::uint64_t joints_at_rest = 0;
  int last_support = 0;
  bool awake = true, was_enabled = true, disturbed = false, fell_asleep = false;
};

struct Slot {
  std::uint32_t generation = 0;
  OdeBodyId id{};
  bool taken = false;
  std::uint64_t birth = 0;
  Making making = {};
  Motion motion = {};
  void archive(StateArchive& a) {
    a(generation, id, taken, birth);
    if (taken) a(making, motion);
  }
};

Making making_of(const Body& body) {
  dMass mass;
  dBodyGetMass(body.body, &mass);
  return {body.shape, body.spheres, mass.mass, body.material, body.geometry, body.properties};
}

Motion motion_of(const Body& body) {
  Motion motion{.state = state_of(body.body), .last_good = body.last_good};
  std::copy_n(dBodyGetRotation(body.body), 12, motion.rotation.begin());
  motion.force = to_vec3(dBodyGetForce(body.body)), motion.torque = to_vec3(dBodyGetTorque(body.body));
  motion.given_force = body.force, motion.given_torque = body.torque;
  motion.held_force = body.held_force, motion.held_torque = body.held_torque;
  motion.last_support = body.last_support;
  motion.to_sleep_s = body.to_sleep_s;
  motion.fell_asleep = body.fell_asleep, motion.withheld = body.withheld;
  motion.joints_at_rest = body.joints_at_rest;
  motion.awake = dBodyIsEnabled(body.body), motion.was_enabled = body.was_enabled,
  motion.disturbed = body.disturbed;
  return motion;
}

void set_motion(Body& body, const Motion& motion) {
  set_state(body.body, motion.state);
  std::ranges::copy(motion.rotation, const_cast<dReal*>(dBodyGetRotation(body.body)));
  dBodySetForce(body.body, motion.force.x(), motion.force.y(), motion.force.z());
  dBodySetTorque(body.body, motion.torque.x(), motion.torque.y(), motion.torque.z());
  body.force = motion.given_force, body.torque = motion.given_torque;
  body.held_force = motion.held_force, body.held_torque = motion.held_torque;
  body.last_good = motion.last_good;
  body.last_support = motion.last_support;
  body.impact.reset();
  body.joints_at_rest = motion.joints_at_rest;
  body.to_sleep_s = motion.to_sleep_s, body.was_enabled = motion.was_enabled,
  body.disturbed = motion.disturbed, body.fell_asleep = motion.fell_asleep;
  body.withheld = motion.withheld;
  motion.awake ? dBodyEnable(body.body) : dBodyDisable(body.body);
}

// In another world, or another future of this one, the same id may be that of quite another body.
bool is_made_alike(const Making& a, const Making& b) {
  const auto same_sphere = [](const Sphere& one, const Sphere& other) {
    return one.center == other.center && one.radius == other.radius;
  };
  return a.shape->content_hash == b.shape->content_hash && a.shape->radius == b.shape->radius &&
         a.mass == b.mass && a.material == b.material && a.geometry == b.geometry &&
         std::ranges::equal(a.spheres, b.spheres, same_sphere);
}

bool is_same(const Body& body, const Slot& slot) {
  return bool(body.body) == slot.taken && (!slot.taken || (body.id == slot.id && body.birth == slot.birth &&
                                                           is_made_alike(making_of(body), slot.making)));
}

}  // namespace

void Bodies::archive(StateArchive& a, dWorldID world, const OdeSettings& settings, TrimeshCache& cache) {
  std::vector<Slot> slots;
  if (!a.reading())
    for (const Body& body : slots_)
      slots.push_back(body.body
                          ? Slot{body.generation, body.id, true, body.birth, making_of(body), motion_of(body)}
                          : Slot{.generation = body.generation});
  std::vector<std::uint32_t> free = free_;
  std::uint64_t births = births_;
  a(slots, free, births);
  if (!a.reading()) return;

  if (!std::ranges::equal(slots_, slots, is_same)) {
    if (std::ranges::any_of(slots_,
                            [](const Body& body) { return body.body && dBodyGetNumJoints(body.body) > 0; }))
      throw_input_error("snapshot", "other full bodies than those here, of which one has a joint",
                        "the same bodies, or none with a joint");
    clear();
    slots_.resize(slots.size());
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < slots.size(); ++i)
      if (slots[i].taken) order.push_back(i);
    std::ranges::sort(order, {}, [&](std::size_t i) { return slots[i].birth; });
    for (std::size_t i = 0; i < slots.size(); ++i) slots_[i].generation = slots[i].generation;
    for (const std::size_t i : order) {
      const Making& making = slots[i].making;
      make(i, world,
           {.shape = making.shape,
            .mass = making.mass,
            .material = making.material,
            .state = slots[i].motion.state,
            .geometry = making.geometry,
            .spheres = making.spheres,
            .properties = making.properties},
           settings, cache);
      slots_[i].birth = slots[i].birth;
    }
  }
  for (std::size_t i = 0; i < slots.size(); ++i)
    if (slots[i].taken) {
      set_properties(slots_[i], slots[i].making.properties);
      set_motion(slots_[i], slots[i].motion);
    }
  free_ = std::move(free);
  births_ = births;
}

}  // namespace lodestone::ode
