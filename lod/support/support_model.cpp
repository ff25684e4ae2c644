#include "lod/support/support_model.h"

#include <algorithm>
#include <cmath>

#include "lod/support/contact_at_once.h"
#include "lod/support/contact_steps.h"
#include "lod/support/hull_flight.h"
#include "lod/support/hull_impacts.h"

namespace lodestone {
namespace {

// On what is more slippery bodies rock on as they slide, and strike a third of a deviation too often.
constexpr double kLeastFrictionAtOnce = 0.3;

constexpr double kWithinReach = 1.2;  // over R

// Off one of two walls that lean against each other a body that is lifted goes into the other.
bool is_wedged(const Vec3& position, double radius, std::span<const HalfSpace> planes) {
  const auto is_near = [&](const HalfSpace& p) { return p.height_of(position) < kWithinReach * radius; };
  for (std::size_t i = 1; i < planes.size(); ++i)
    for (std::size_t j = 0; j < i && is_near(planes[i]); ++j)
      if (planes[i].normal.dot(planes[j].normal) < 0.0 && is_near(planes[j])) return true;
  return false;
}

// In the corner of a room it meets more planes than it has room for at once.
bool is_in_corner(const StatisticalBody& body, double radius, std::span<const HalfSpace> planes,
                  double time) {
  const double reach = kWithinReach * radius + body.velocity.norm() * time;
  const auto is_near = [&](const HalfSpace& p) { return std::abs(p.height_of(body.position)) < reach; };
  return std::ranges::count_if(planes, is_near) > kMostPlanesAtOnce;
}

bool may_move_at_once(const StatisticalBody& body, const BodyKind& kind, const StepWorld& world, double time,
                      const SupportSettings& settings) {
  return settings.step_at_once > 0.0 && kind.angular && !world.solids &&
         std::ranges::all_of(world.planes,
                             [&](const HalfSpace& plane) {
                               return world.law(kind, plane).friction >= kLeastFrictionAtOnce;
                             }) &&
         !is_wedged(body.position, kind.shape->radius, world.planes) &&
         !is_in_corner(body, kind.shape->radius, world.planes, time);
}

// Whether the vertex that is lowest at the step's end touches already: then nothing strikes, the body only
// leans on. The flight of `body` is that before a torque has given it anything.
bool touches_already(const HullFlight& flight, const StatisticalBody& body, const Shape& shape,
                     const HalfSpace& plane, LowestPoint lowest, double bounce_velocity) {
  const HullPose now{body.position, body.orientation};
  lowest.normal = now.orientation.conjugate() * plane.normal;
  if (shape.sphere_radius) lowest.arm = -*shape.sphere_radius * lowest.normal;
  const bool touches =
      plane.height_of(now.position) + lowest.arm.dot(lowest.normal) < kTouching * shape.radius;
  return touches && (shape.sphere_radius || flight.gap_motion(now, lowest, 0.0).velocity > -bounce_velocity);
}

}  // namespace

[[gnu::flatten]] ContactTally step_support_body(StatisticalBody& body, const BodyKind& kind,
                                                const StepWorld& world, double time,
                                                const SupportSettings& settings, const Quat* turned) {
  ContactTally tally;
  double left = time;
  // A torque acts at once on what flies, step by step on what touches the ground.
  const bool is_turned = !world.turning.isZero(0.0);
  const StatisticalBody before = is_turned ? body : StatisticalBody();
  body.spin += world.turning * time;
  const int most_impacts = world.solids ? 0 : settings.max_impacts;
  for (int hit = 0; hit < most_impacts && left > 0.0; ++hit) {
    const HullFlight flight(body, kind, world, settings.coarse ? left : 0.0);
    std::int32_t hint = body.support_hint;
    Impact end{
        left, hit == 0 && turned ? HullPose{flight.position_at(left), *turned} : flight.pose_at(left), {}};
    end.lowest = flight.find_lowest(end.pose, hint);
    if (end.lowest.plane < 0 || end.lowest.gap >= 0.0) {
      body.position = end.pose.position;
      body.velocity = flight.velocity_at(left);
      body.orientation = end.pose.orientation;
      body.support_hint = hint;
      return tally;
    }
    if (touches_already(is_turned && hit == 0 ? HullFlight(before, kind, world) : flight, body, *kind.shape,
                        world.planes[std::size_t(end.lowest.plane)], end.lowest, world.bounce_velocity)) {
      body.support_hint = hint;
      break;
    }
    const Impact impact = flight.find_impact(end, settings.impact_tolerance * kind.shape->radius, hint);
    if (impact.lowest.plane < 0) break;
    const double approach = -flight.gap_motion(impact.pose, impact.lowest, impact.time).velocity;
    if (approach < world.bounce_velocity) break;  // not a bounce: it stays in contact
    const Vec3 velocity = flight.velocity_at(impact.time);
    body.position = impact.pose.position;
    body.velocity = velocity;
    body.orientation = impact.pose.orientation;
    body.support_hint = hint;
    left -= impact.time;
    respond(body, kind, impact.lowest, approach, world, settings, tally);
    const HalfSpace& plane = world.planes[std::size_t(impact.lowest.plane)];
    if (world.log)
      write_touch(body, world, plane, body.orientation * impact.lowest.arm, approach,
                  (body.velocity - velocity).dot(plane.normal));
    tally.touched_plane = impact.lowest.plane;
    ++tally.contacts;
  }
  if (left > 0.0) {
    body.spin -= world.turning * left;
    const bool at_once = may_move_at_once(body, kind, world, left, settings);
    (at_once ? move_on_planes_at_once : move_on_ground)(body, kind, world, left, settings, tally);
  }
  return tally;
}

}  // namespace lodestone
