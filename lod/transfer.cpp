#include "lod/transfer.h"

#include <algorithm>

#include "reference/hull/hull_overlap.h"

namespace lodestone {
namespace {

// Deeper overlap puts a promotion off, as a fraction of the smaller radius. ODE parts less without a visible jump.
constexpr double kOverlapAllowed = 0.02;

void enter_full(Levels& levels, std::uint32_t body, const RigidState& state, bool asleep) {
  BodyRecord& record = levels.bodies[body];
  const OdeBodyDefinition definition{
      .shape = record.definition.shape, .mass = record.mass, .material = record.definition.material, .state = state};
  record.ode = levels.full.add(body, definition, asleep);
  levels.bodies.candidates()[body].level = Level::full;
}

void enter_statistical(Levels& levels, std::uint32_t body, const RigidState& state, bool asleep) {
  BodyRecord& record = levels.bodies[body];
  const BodyDefinition& definition = record.definition;
  if (!levels.statistical)
    levels.statistical = std::make_unique<StatisticalLevel>(levels.statistical_settings, levels.ground, levels.materials);
  record.slot = levels.statistical->add(body, definition.shape, record.mass, definition.material, state, asleep,
                                        levels.signatures.find(*definition.shape, levels.ground_law(definition.material)));
  levels.owner_of_slot.resize(std::max<std::size_t>(levels.owner_of_slot.size(), record.slot + 1));
  levels.owner_of_slot[record.slot] = body;
  levels.bodies.candidates()[body].level = Level::statistical;
}

void enter(Levels& levels, std::uint32_t body, Level level, const RigidState& state, bool asleep) {
  if (level == Level::full) enter_full(levels, body, state, asleep);
  else enter_statistical(levels, body, state, asleep);
  levels.bodies.candidates()[body].frames_since_change = 0;
}

/// The level that is left wakes what the body touched there.
void leave(Levels& levels, std::uint32_t body) {
  BodyRecord& record = levels.bodies[body];
  if (record.ode) {
    levels.full.remove(record.ode);
    record.ode = {};
  } else if (record.slot >= 0) {
    if (const auto moved = levels.statistical->remove(record.slot)) {
      levels.bodies[*moved].slot = record.slot;
      levels.owner_of_slot[record.slot] = *moved;
    }
    levels.owner_of_slot.pop_back();
    record.slot = -1;
  }
}

bool overlaps_ground(const Levels& levels, const Shape& shape, const RigidState& state) {
  return std::ranges::any_of(levels.ground.planes, [&](const HalfSpace& plane) {
    return measure_plane_overlap(shape, state, plane.normal, plane.offset) > kOverlapAllowed * shape.radius;
  });
}

}  // namespace

void place(Levels& levels, std::uint32_t body, Level level) {
  enter(levels, body, level, levels.bodies[body].definition.state, false);
  levels.bodies.candidates()[body].newcomer = false;
  levels.bodies.candidates()[body].frames_since_change = LevelCandidate{}.frames_since_change;
}

void transfer(Levels& levels, std::uint32_t body) {
  const RigidState state = levels.state(body);
  const bool asleep = levels.asleep(body);
  const Level to = levels.bodies[body].ode ? Level::statistical : Level::full;
  levels.wake_near(body, to);
  leave(levels, body);
  enter(levels, body, to, state, asleep);
}

void take_out(Levels& levels, std::uint32_t body) {
  levels.wake_near(body, levels.bodies[body].ode ? Level::statistical : Level::full);
  leave(levels, body);
}

bool overlaps(const Levels& levels, std::uint32_t body) {
  const auto& candidates = levels.bodies.candidates();
  const RigidState state = levels.state(body);
  const Shape& shape = *levels.bodies[body].definition.shape;
  if (overlaps_ground(levels, shape, state)) return true;
  for (std::uint32_t other = 0; other < levels.bodies.indices(); ++other) {
    const double reach = shape.radius + candidates[other].radius;
    if (other == body || !levels.bodies.alive(other)) continue;
    if ((candidates[other].position - state.position).squaredNorm() > reach * reach) continue;
    const Shape& other_shape = *levels.bodies[other].definition.shape;
    const double allowed = kOverlapAllowed * std::min(shape.radius, other_shape.radius);
    if (measure_hull_overlap(shape, state, other_shape, levels.state(other)) > allowed) return true;
  }
  return false;
}

}  // namespace lodestone
