#include "lod/levels.h"

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
  if (record.slot >= 0) return statistical->state(record.slot);
  return record.definition.state;
}

bool Levels::asleep(std::uint32_t body) const {
  const BodyRecord& record = bodies[body];
  if (record.ode) return full.world()->asleep(record.ode);
  return record.slot >= 0 && statistical->asleep(record.slot);
}

void Levels::set_state(std::uint32_t body, const RigidState& state) {
  BodyRecord& record = bodies[body];
  wake_near(body, Level::full);
  wake_near(body, Level::statistical);
  if (record.ode) full.world()->set_state(record.ode, state);
  else if (record.slot >= 0) statistical->set_state(record.slot, state);
  else record.definition.state = state;
  bodies.candidates()[body].position = state.position;
  wake(body);
}

void Levels::wake(std::uint32_t body) {
  const BodyRecord& record = bodies[body];
  if (!asleep(body)) return;
  if (record.ode) full.world()->set_asleep(record.ode, false);
  else statistical->wake(record.slot);
}

void Levels::wake_near(std::uint32_t body, Level level) {
  const auto& candidates = bodies.candidates();
  const Vec3 position = state(body).position;
  for (std::uint32_t other = 0; other < bodies.indices(); ++other) {
    const LevelCandidate& candidate = candidates[other];
    const double reach = (1.0 + kTouchMargin) * (candidates[body].radius + candidate.radius);
    const bool near = (candidate.position - position).squaredNorm() <= reach * reach;
    if (near && candidate.level == level && other != body) wake(other);
  }
}

void Levels::give_force(std::uint32_t body) {
  BodyRecord& record = bodies[body];
  if (record.ode) full.world()->add_force(record.ode, record.force, record.torque);
  else if (record.slot >= 0) statistical->add_force(record.slot, record.force, record.torque);
  record.force = record.torque = Vec3::Zero();
}

}  // namespace lodestone
