#include "lod/manager/levels.h"

#include <algorithm>

namespace lodestone {
namespace {

// Bodies at rest on each other are apart by less than this fraction of their radii.
constexpr double kTouchMargin = 0.05;

}  // namespace

ContactLaw Levels::ground_law(MaterialId material) const {
  return materials.law(material, ground.planes.empty() ? 0 : ground.planes.front().material);
}

RigidState Levels::state(std::uint32_t body) const {
  const BodyRecord& record = bodies[body];
  if (record.ode) return full.world()->state(record.ode);
  if (record.statistical) return statistical->state(record.statistical);
  return bodies.newcomer(body).state;
}

bool Levels::asleep(std::uint32_t body) const {
  const BodyRecord& record = bodies[body];
  if (record.ode) return full.world()->asleep(record.ode);
  return record.statistical && statistical->asleep(record.statistical);
}

void Levels::set_state(std::uint32_t body, const RigidState& state) {
  BodyRecord& record = bodies[body];
  wake_near(body, Level::full);
  wake_near(body, Level::statistical);
  if (record.ode) full.world()->set_state(record.ode, state);
  else if (record.statistical) statistical->set_state(record.statistical, state);
  else bodies.newcomer(body).state = state;
  wake(body);
}

void Levels::wake(std::uint32_t body) {
  const BodyRecord& record = bodies[body];
  if (!asleep(body)) return;
  if (record.ode) full.world()->set_asleep(record.ode, false);
  else statistical->wake(record.statistical);
}

void Levels::wake_near(std::uint32_t body, Level level) {
  std::vector<std::uint32_t> near;
  find_near(body, 1.0 + kTouchMargin, level, near, true);
  std::ranges::sort(near);
  for (const std::uint32_t other : near) wake(other);
}

void Levels::find_near(std::uint32_t body, double factor, Level level, std::vector<std::uint32_t>& near, bool asleep_only) const {
  const Vec3 position = state(body).position;
  const double radius = bodies.shape(body)->radius;
  const auto add = [&](std::uint32_t other, const Vec3& place) {
    const double reach = factor * (radius + bodies.shape(other)->radius);
    if (other != body && (place - position).squaredNorm() <= reach * reach) near.push_back(other);
  };
  if (level == Level::full) {
    for (const FullLevel::Member& member : full.members()) add(member.owner, full.world()->state(member.id).position);
    return;
  }
  if (!statistical) return;
  std::vector<std::uint32_t> owners;
  statistical->find_sleepers(position, factor * (radius + statistical->reach()) - statistical->reach(), owners);
  if (!asleep_only) statistical->find_awake(owners);
  for (const std::uint32_t owner : owners) add(owner, statistical->position(bodies[owner].statistical));
}

PairWeights Levels::full_pairs() const {
  PairWeights all;
  double most_radius = 0.0;
  for (const FullLevel::Member& member : full.members()) most_radius = std::max(most_radius, bodies.shape(member.owner)->radius);
  FullPairs pairs(most_radius);
  for (const FullLevel::Member& member : full.members()) {
    const Shape& shape = *bodies.shape(member.owner);
    const FullPairs::Body body{full.world()->state(member.id).position, shape.radius, mesh_weight(shape), full.world()->asleep(member.id)};
    const PairWeights met = pairs.meet(body);
    all.awake += met.awake, all.asleep += met.asleep, all.dearest = std::max(all.dearest, met.dearest);
    pairs.add(body);
  }
  return all;
}

void Levels::give_forces() {
  for (const std::uint32_t body : bodies.pushed()) {
    const BodyRecord& record = bodies[body];
    const auto [force, torque] = bodies.force(body);
    if (record.ode) full.world()->add_force(record.ode, force, torque);
    else if (record.statistical) statistical->add_force(record.statistical, force, torque);
  }
  bodies.clear_forces();
}

}  // namespace lodestone
