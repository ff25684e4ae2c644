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
      .shape = levels.bodies.shape(body), .mass = record.mass, .material = record.material, .state = state};
  record.ode = levels.full.add(body, definition, asleep);
  record.slot = -1;
  levels.bodies.level(body).level = Level::full;
}

void enter_statistical(Levels& levels, std::uint32_t body, const RigidState& state, bool asleep) {
  BodyRecord& record = levels.bodies[body];
  const std::shared_ptr<const Shape>& shape = levels.bodies.shape(body);
  if (!levels.statistical)
    levels.statistical = std::make_unique<StatisticalLevel>(levels.statistical_settings, levels.ground, levels.materials);
  record.slot = levels.statistical->add(body, shape, record.mass, record.material, state, asleep,
                                        levels.signatures.find(*shape, levels.ground_law(record.material)));
  levels.owner_of_slot.resize(std::max<std::size_t>(levels.owner_of_slot.size(), record.slot + 1));
  levels.owner_of_slot[record.slot] = body;
  levels.bodies.level(body).level = Level::statistical;
}

void enter(Levels& levels, std::uint32_t body, Level level, const RigidState& state, bool asleep) {
  if (level == Level::full) enter_full(levels, body, state, asleep);
  else enter_statistical(levels, body, state, asleep);
  levels.bodies.level(body).changed_at = levels.now;
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
  const RigidState given = levels.bodies.given_state(body);
  enter(levels, body, level, given, false);
  levels.bodies.level(body).newcomer = false;
  levels.bodies.level(body).changed_at = BodyLevel::kLongAgo;
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
  const RigidState state = levels.state(body);
  const Shape& shape = *levels.bodies.shape(body);
  if (overlaps_ground(levels, shape, state)) return true;
  const auto overlaps_body = [&](std::uint32_t other, const RigidState& there) {
    const Shape& other_shape = *levels.bodies.shape(other);
    const double reach = shape.radius + other_shape.radius, allowed = kOverlapAllowed * std::min(shape.radius, other_shape.radius);
    return other != body && (there.position - state.position).squaredNorm() <= reach * reach && measure_hull_overlap(shape, state, other_shape, there) > allowed;
  };
  std::vector<std::uint32_t> near;
  levels.find_near(body, 1.0, Level::full, near, false);
  levels.find_near(body, 1.0, Level::statistical, near, false);
  if (std::ranges::any_of(near, [&](std::uint32_t other) { return overlaps_body(other, levels.state(other)); })) return true;
  const auto& newcomers = levels.bodies.newcomers();
  for (std::size_t i = 0; i < newcomers.size(); ++i)
    if (levels.bodies.is_newcomer_at(i) && overlaps_body(newcomers[i].index, newcomers[i].state)) return true;
  return false;
}

}  // namespace lodestone
