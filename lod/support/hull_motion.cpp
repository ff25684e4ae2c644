#include "lod/support/hull_motion.h"

#include <algorithm>

#include "lod/contact/hull_contacts.h"

namespace lodestone {
namespace {

// It rocks on the ground for as long as the clip plays, which gives it what changes its motion but for
// gravity.
ContactRecord touch_of_clip(const StatisticalBody& body, const HalfSpace& ground, const Vec3& given) {
  return {.first = body.owner,
          .ground = ground.id,
          .ground_material = ground.material,
          .point = body.position - ground.height_of(body.position) * ground.normal,
          .normal = ground.normal,
          .impulse = body.mass * std::max(0.0, given.dot(ground.normal))};
}

bool reaches_into(const HalfSpace& plane, const StatisticalBody& body, const Shape& shape) {
  const double height = plane.height_of(body.position);
  if (height >= shape.radius) return false;
  std::int32_t hint = body.support_hint;
  return find_lowest_point(shape, body.orientation, plane.normal, height, hint).gap < 0.0;
}

}  // namespace

HullMotion move_on_hull(StatisticalBody& body, ClipPlayback& clip, const BodyKind& kind,
                        const StepWorld& world, const Vec3& clip_gravity, double time, bool may_settle,
                        const HullMotionSettings& settings, const Quat* turned) {
  const double gravity = clip_gravity.norm();
  // A clip plays on its own ground only: that of a static solid ends at an edge. The triangles of a level
  // floor are one, up to rounding.
  constexpr double kSame = 1e-3;  // over R
  const auto same = [&](const HalfSpace& plane) {
    const double radius = kind.shape->radius;
    return (plane.normal - clip.ground.normal).norm() * radius +
               std::abs(plane.height_of(body.position) - clip.ground.height_of(body.position)) <=
           kSame * radius;
  };
  if (body.motion == Motion::settling && std::ranges::none_of(world.planes, same))
    body.motion = Motion::dynamic;
  if (body.motion == Motion::settling) {
    const StatisticalBody before = body;
    const Vec3 falling = body.velocity + world.gravity * time;
    const bool over = advance_clip(clip, body, kind, gravity, time, settings.clips);
    // It was recorded where there is no wall.
    const auto meets = [&](const HalfSpace& plane) {
      return !same(plane) && reaches_into(plane, body, *kind.shape);
    };
    if (std::ranges::none_of(world.planes, meets)) {
      if (world.log) world.log->add(touch_of_clip(body, clip.ground, body.velocity - falling));
      return {.plays_clip = true, .clip_over = over};
    }
    body = before;
    body.motion = Motion::dynamic;
  }
  const ContactTally tally = step_support_body(body, kind, world, time, settings.support, turned);
  if (tally.touched_plane < 0 || !may_settle || !kind.clips || kind.clips->empty()) return {.tally = tally};
  const HalfSpace& plane = world.planes[std::size_t(tally.touched_plane)];
  if (!world.is_horizontal(plane)) return {.tally = tally};
  const auto joined = find_clip(body, kind, plane, gravity, settings.clips);
  if (!joined) return {.tally = tally};
  clip = *joined;
  body.motion = Motion::settling;
  return {.tally = tally, .plays_clip = true};
}

bool stands_firmly(const StatisticalBody& body, const Shape& shape, std::span<const HalfSpace> planes) {
  constexpr double kFlat = 0.02;  // over R
  if (shape.sphere_radius) return true;
  int vertices = 0;
  for (const HalfSpace& plane : planes) {
    const double height = plane.height_of(body.position), margin = kFlat * shape.radius;
    if (height > shape.radius + margin) continue;
    std::int32_t hint = body.support_hint;
    const HullContacts low = find_hull_contacts(shape, body.orientation, plane.normal, height, margin, hint);
    for (int i = 0; i < low.count; ++i) vertices += low.contact[std::size_t(i)].gap < margin;
  }
  return vertices >= 3;
}

}  // namespace lodestone
