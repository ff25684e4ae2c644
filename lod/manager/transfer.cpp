#include "lod/manager/transfer.h"

#include <algorithm>
#include <utility>

#include "lod/ground/met_ground.h"
#include "lod/statistical/parting.h"
#include "reference/error.h"
#include "reference/hull/hull_overlap.h"
#include "reference/ode/body_joints.h"

namespace lodestone {
namespace {

// Deeper overlap puts a promotion off, as a fraction of the smaller radius. ODE parts less without a visible
// jump.
constexpr double kOverlapAllowed = 0.02;

void enter_full(Levels& levels, std::uint32_t body, const RigidState& state, bool asleep) {
  BodyRecord& record = levels.bodies[body];
  const OdeBodyDefinition definition{.shape = levels.bodies.shape(body),
                                     .mass = record.mass,
                                     .material = record.material,
                                     .state = state,
                                     .properties = levels.bodies.properties(body)};
  record.ode = levels.full.add(body, definition, asleep);
  levels.note_full(body);
}

// From one statistical rung to the other it keeps the one that it has: the ground's law may be another by
// now, for which none is there yet, or ever.
std::shared_ptr<const Signature> signature_of(Levels& levels, std::uint32_t body) {
  if (const auto& own = levels.own_signature(body)) return own;
  if (levels.bodies.level(body).waits_for_signature) return nullptr;  // it goes without
  return levels.signatures.find(*levels.bodies.shape(body), levels.ground_law(levels.bodies[body].material));
}

void enter_statistical(Levels& levels, std::uint32_t body, StatisticalModel model, const RigidState& state,
                       bool asleep, bool arrives, std::shared_ptr<const Signature> signature) {
  BodyRecord& record = levels.bodies[body];
  const std::shared_ptr<const Shape>& shape = levels.bodies.shape(body);
  if (!levels.statistical)
    levels.statistical =
        std::make_unique<StatisticalLevel>(levels.statistical_settings, levels.ground, levels.materials);
  record.statistical = levels.statistical->add(model, body, shape, record.mass, record.material, state,
                                               asleep, std::move(signature), arrives);
}

/// `arrives`: from another rung.
void enter(Levels& levels, std::uint32_t body, Rung rung, const RigidState& state, bool asleep, bool arrives,
           std::shared_ptr<const Signature> signature) {
  if (rung == Rung::full)
    enter_full(levels, body, state, asleep);
  else
    enter_statistical(levels, body,
                      rung == Rung::tables ? StatisticalModel::tables : StatisticalModel::support, state,
                      asleep, arrives, std::move(signature));
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
    if (const auto moved = levels.statistical->remove(record.statistical, stays))
      levels.bodies[*moved].statistical = record.statistical;
    record.statistical = {};
  }
}

bool overlaps_planes(std::span<const HalfSpace> planes, const Shape& shape, const RigidState& state) {
  return std::ranges::any_of(planes, [&](const HalfSpace& plane) {
    return measure_plane_overlap(shape, state, plane.normal, plane.offset) > kOverlapAllowed * shape.radius;
  });
}

bool is_carried(const Levels& levels, std::uint32_t body, const RigidState& state) {
  if (levels.statistical->is_carried(levels.bodies[body].statistical)) return true;
  std::vector<const GroundPart*> near;
  levels.ground.find_parts(state.position, levels.bodies.shape(body)->radius, near);
  return std::ranges::any_of(near, &GroundPart::moves);
}

// Whether it leans on others there, or may do so, and hardly moves. What is carried goes on with its carrier.
bool lies_among_others(const Levels& levels, std::uint32_t body, const RigidState& state) {
  const Activity does = levels.statistical->activity(levels.bodies[body].statistical);
  const double radius = levels.bodies.shape(body)->radius,
               slow = 4.0 * parting_speed(radius, levels.statistical_settings.gravity.norm());
  return does != Activity::alone && state.velocity.norm() <= slow &&
         state.angular_velocity.norm() * radius <= slow && !is_carried(levels, body, state);
}

// m that its mesh may be above what its hull lies on, at most, where it is hollow.
double find_gap_below(const Shape& shape) {
  constexpr double kHollow = 0.3;  // over R
  return shape.convex || !shape.pieces.empty() ? 0.0 : kHollow * shape.radius;
}

// With planes and the parts of the ground; those known by rays count as the plane below.
bool overlaps_ground(const MetGround& ground, const Shape& shape, const RigidState& state) {
  if (overlaps_planes(ground.planes(), shape, state)) return true;
  const double allowed = kOverlapAllowed * shape.radius;
  std::vector<const GroundPart*> parts;
  std::vector<PlacedSolid> near;
  std::vector<HalfSpace> probed;
  ground.find_parts(state.position, shape.radius, parts);
  for (const GroundPart* part : parts) {
    find_solids(*part, state.position, shape.radius, 0.0, near);
    if (const auto plane = probe_below(*part, state.position, shape.radius)) probed.push_back(*plane);
  }
  return overlaps_planes(probed, shape, state) || std::ranges::any_of(near, [&](const PlacedSolid& solid) {
           RigidState at;
           at.position = solid.position;
           at.orientation = solid.orientation;
           return measure_pair_overlap(shape, state, *solid.solid->shape, at, allowed) > allowed;
         });
}

// What hangs on joints may yield to what is laid on it, however gently.
void wake_sprung(Levels& levels, std::uint32_t body) {
  if (levels.full.members().empty()) return;
  std::vector<std::uint32_t> near;
  levels.find_near(body, 1.0 + kTouchMargin, Level::full, near, true);
  std::ranges::sort(near);
  for (const std::uint32_t other : near)
    if (has_joints(levels.full.world()->ode_body(levels.bodies[other].ode))) levels.wake(other);
}

}  // namespace

void find_signature(Levels& levels, std::uint32_t body, Rung rung) {
  const auto signature = signature_of(levels, body);
  if (rung != Rung::tables || levels.bodies.level(body).waits_for_signature) return;
  const std::string name = "signature of shape " + levels.bodies.shape(body)->name;
  if (!signature) throw_input_error(name, "none", "one, without which the body cannot be at tables");
  if (signature->collision_heights.mean.empty())
    throw_input_error(name, "no collision heights", "some, without which the body cannot be at tables");
}

void place(Levels& levels, std::uint32_t body, Rung rung) {
  const RigidState given = levels.bodies.newcomer(body).state;
  enter(levels, body, rung, given, levels.bodies.newcomer(body).asleep, false,
        rung == Rung::full ? nullptr : signature_of(levels, body));
  levels.bodies[body].newcomer = -1;
  levels.bodies.level(body).newcomer = false;
  levels.bodies.level(body).changed_at = BodyLevel::kLongAgo;
  if (!levels.asleep(body)) wake_sprung(levels, body);
}

void transfer(Levels& levels, std::uint32_t body, Rung to) {
  const RigidState state = levels.state(body);
  const bool asleep = levels.asleep(body);
  auto signature = to == Rung::full ? nullptr : signature_of(levels, body);
  if (!asleep) {
    const Level from = level_of(levels.bodies.level(body).rung);
    levels.wake_near(body, level_of(to));
    if (from == level_of(to)) levels.wake_near(body, Level::full);
  }
  const Rung before = levels.bodies.level(body).rung;
  const bool lies = to == Rung::full && levels.bodies[body].statistical &&
                    (asleep || lies_among_others(levels, body, state));
  leave(levels, body, asleep);
  enter(levels, body, to, state, asleep, true, std::move(signature));
  if (lies) {
    const Shape& shape = *levels.bodies.shape(body);
    levels.eased.add(body, levels.bodies[body].ode, state.position, shape.radius, find_gap_below(shape));
  }
  if (before != to) levels.rung_changes.push_back({levels.bodies.id(body), before, to});
}

void take_out(Levels& levels, std::uint32_t body) {
  levels.wake_near(body, levels.bodies[body].ode ? Level::statistical : Level::full);
  leave(levels, body, false);
}

bool overlaps(const Levels& levels, std::uint32_t body, std::span<const std::uint32_t> but) {
  const RigidState state = levels.state(body);
  const Shape& shape = *levels.bodies.shape(body);
  const BodyProperties& own = levels.bodies.properties(body);
  // The ground does not push what is kinematic.
  if (!own.kinematic && overlaps_ground({levels.ground, own}, shape, state)) return true;
  const auto may_push = [&](std::uint32_t other) {
    const BodyProperties& its = levels.bodies.properties(other);
    const auto& may_pair = levels.statistical_settings.pair_filter;
    return may_meet(own, its) && (!may_pair || may_pair(body, other));
  };
  const auto overlaps_body = [&](std::uint32_t other, const RigidState& there) {
    const Shape& other_shape = *levels.bodies.shape(other);
    const double reach = shape.radius + other_shape.radius,
                 allowed = kOverlapAllowed * std::min(shape.radius, other_shape.radius);
    return other != body && std::ranges::find(but, other) == but.end() &&
           (there.position - state.position).squaredNorm() <= reach * reach && may_push(other) &&
           measure_pair_overlap(shape, state, other_shape, there, allowed) > allowed;
  };
  std::vector<std::uint32_t> near;
  levels.find_near(body, 1.0, Level::full, near, false);
  levels.find_near(body, 1.0, Level::statistical, near, false);
  if (std::ranges::any_of(near,
                          [&](std::uint32_t other) { return overlaps_body(other, levels.state(other)); }))
    return true;
  bool meets_callers = false;
  levels.callers.bodies.each_near(
      state.position, shape.radius, own, [&](const Shape& other, const RigidState& there) {
        const double allowed = kOverlapAllowed * std::min(shape.radius, other.radius);
        meets_callers |= measure_pair_overlap(shape, state, other, there, allowed) > allowed;
      });
  if (meets_callers) return true;
  const auto& newcomers = levels.bodies.newcomers();
  for (std::size_t i = 0; i < newcomers.size(); ++i)
    if (levels.bodies.waits_at(i) && overlaps_body(newcomers[i].index, newcomers[i].state)) return true;
  return false;
}

}  // namespace lodestone
