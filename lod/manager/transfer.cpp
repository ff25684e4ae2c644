#include "lod/manager/transfer.h"

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
}

void enter_statistical(Levels& levels, std::uint32_t body, StatisticalModel model, const RigidState& state, bool asleep, bool arrives) {
  BodyRecord& record = levels.bodies[body];
  const std::shared_ptr<const Shape>& shape = levels.bodies.shape(body);
  if (!levels.statistical)
    levels.statistical = std::make_unique<StatisticalLevel>(levels.statistical_settings, levels.ground, levels.materials);
  record.statistical = levels.statistical->add(model, body, shape, record.mass, record.material, state, asleep,
                                               levels.signatures.find(*shape, levels.ground_law(record.material)), arrives);
}

/// `arrives`: from another rung.
void enter(Levels& levels, std::uint32_t body, Rung rung, const RigidState& state, bool asleep, bool arrives) {
  if (rung == Rung::full) enter_full(levels, body, state, asleep);
  else enter_statistical(levels, body, rung == Rung::tables ? StatisticalModel::tables : StatisticalModel::support, state, asleep, arrives);
  levels.bodies.level(body).rung = rung;
  levels.bodies.level(body).changed_at = levels.now;
}

/// The rung that is left wakes what the body touched there, unless it stays where it is.
void leave(Levels& levels, std::uint32_t body, bool stays) {
  BodyRecord& record = levels.bodies[body];
  if (record.ode) {
    levels.full.remove(record.ode, stays);
    record.ode = {};
  } else if (record.statistical) {
    if (const auto moved = levels.statistical->remove(record.statistical, stays)) levels.bodies[*moved].statistical = record.statistical;
    record.statistical = {};
  }
}

bool overlaps_ground(const Levels& levels, const Shape& shape, const RigidState& state) {
  return std::ranges::any_of(levels.ground.planes, [&](const HalfSpace& plane) {
    return measure_plane_overlap(shape, state, plane.normal, plane.offset) > kOverlapAllowed * shape.radius;
  });
}

template <class Visit>
void each_piece(const Shape& shape, const RigidState& state, const Visit& visit) {
  if (shape.pieces.empty()) return visit(shape, state);
  for (const Shape& piece : shape.pieces) {
    RigidState at = state;
    at.position += state.orientation * piece.center_of_mass_in_mesh;
    visit(piece, at);
  }
}

// m: of the hulls or, where these overlap by more than is allowed, of the convex pieces of those that have some, so that one L may hook into another.
double measure_overlap(const Shape& first, const RigidState& at_first, const Shape& second, const RigidState& at_second, double allowed) {
  const double of_hulls = measure_hull_overlap(first, at_first, second, at_second);
  if (of_hulls <= allowed || (first.pieces.empty() && second.pieces.empty())) return of_hulls;
  double deepest = 0.0;
  each_piece(first, at_first, [&](const Shape& a, const RigidState& at_a) {
    each_piece(second, at_second, [&](const Shape& b, const RigidState& at_b) { deepest = std::max(deepest, measure_hull_overlap(a, at_a, b, at_b)); });
  });
  return deepest;
}

}  // namespace

void place(Levels& levels, std::uint32_t body, Rung rung) {
  const RigidState given = levels.bodies.newcomer(body).state;
  enter(levels, body, rung, given, false, false);
  levels.bodies[body].newcomer = -1;
  levels.bodies.level(body).newcomer = false;
  levels.bodies.level(body).changed_at = BodyLevel::kLongAgo;
}

void transfer(Levels& levels, std::uint32_t body, Rung to) {
  const RigidState state = levels.state(body);
  const bool asleep = levels.asleep(body);
  if (!asleep) {
    const Level from = level_of(levels.bodies.level(body).rung);
    levels.wake_near(body, level_of(to));
    if (from == level_of(to)) levels.wake_near(body, Level::full);
  }
  leave(levels, body, asleep);
  enter(levels, body, to, state, asleep, true);
}

void take_out(Levels& levels, std::uint32_t body) {
  levels.wake_near(body, levels.bodies[body].ode ? Level::statistical : Level::full);
  leave(levels, body, false);
}

bool overlaps(const Levels& levels, std::uint32_t body) {
  const RigidState state = levels.state(body);
  const Shape& shape = *levels.bodies.shape(body);
  if (overlaps_ground(levels, shape, state)) return true;
  const auto overlaps_body = [&](std::uint32_t other, const RigidState& there) {
    const Shape& other_shape = *levels.bodies.shape(other);
    const double reach = shape.radius + other_shape.radius, allowed = kOverlapAllowed * std::min(shape.radius, other_shape.radius);
    return other != body && (there.position - state.position).squaredNorm() <= reach * reach && measure_overlap(shape, state, other_shape, there, allowed) > allowed;
  };
  std::vector<std::uint32_t> near;
  levels.find_near(body, 1.0, Level::full, near, false);
  levels.find_near(body, 1.0, Level::statistical, near, false);
  if (std::ranges::any_of(near, [&](std::uint32_t other) { return overlaps_body(other, levels.state(other)); })) return true;
  const auto& newcomers = levels.bodies.newcomers();
  for (std::size_t i = 0; i < newcomers.size(); ++i)
    if (levels.bodies.waits_at(i) && overlaps_body(newcomers[i].index, newcomers[i].state)) return true;
  return false;
}

}  // namespace lodestone
