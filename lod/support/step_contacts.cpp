#include "lod/support/step_contacts.h"

#include <algorithm>

namespace lodestone {

GroundContact vertex_contact(const StatisticalBody& body, const BodyKind& kind, const StepWorld& world,
                             const Mat3& rotation, std::int32_t vertex, int plane_index) {
  const HalfSpace& plane = world.planes[std::size_t(plane_index)];
  const Vec3 normal = rotation.transpose() * plane.normal,
             &arm = kind.shape->hull.vertices[std::size_t(vertex)];
  return {.normal = normal,
          .arm = arm,
          .gap = plane.height_of(body.position) + arm.dot(normal),
          .law = world.law(kind, plane)};
}

void find_step_contacts(StatisticalBody& body, const BodyKind& kind, const StepWorld& world,
                        const OnGround& on, double time, double least_margin, const HeldVertices& held,
                        StepContacts& found) {
  const Shape& shape = *kind.shape;
  found.count = 0;
  found.deepest = 0.0;
  for (std::size_t i = 0; i < world.planes.size(); ++i) {
    if (found.count + kMaxGroundContacts > StepContacts::kCapacity) return;
    const HalfSpace& plane = world.planes[i];
    const double height = plane.height_of(body.position), drop = body.velocity.dot(plane.normal) * time;
    // What the ground gives one point may turn another down as fast as the body fell.
    const double fall = std::max(0.0, -drop), margin = least_margin + fall;
    const Vec3 normal = on.rotation.transpose() * plane.normal;
    const GapChange change{drop, normal.cross(on.motion.angular_velocity) * time};
    const double reach = margin + fall + change.of_arm.norm() * shape.radius;
    if (height > shape.radius + reach) continue;
    const HullContacts low =
        find_hull_contacts(shape, body.orientation, plane.normal, height, margin, body.support_hint, change);
    for (int k = 0; k < low.count; ++k) {
      const HullContact& point = low.contact[std::size_t(k)];
      if (point.gap > reach) continue;
      found.add({.normal = normal,
                 .arm = arm_of(point, shape, normal),
                 .gap = point.gap,
                 .law = world.law(kind, plane),
                 .guess = on.rotation.transpose() * held.find(point.vertex)},
                point.vertex, int(i));
      if (point.gap < found.deepest) found.deepest = point.gap, found.deepest_plane = int(i);
    }
  }
}

int add_sinking(const StatisticalBody& body, const BodyKind& kind, const StepWorld& world, const OnGround& on,
                double time, StepContacts& found) {
  const Shape& shape = *kind.shape;
  if (shape.sphere_radius) return 0;
  const int plane_index = found.plane[found.count - 1];
  const HalfSpace& plane = world.planes[std::size_t(plane_index)];
  const double height = plane.height_of(body.position + on.rotation * on.motion.velocity * time),
               deep = -kTouching * shape.radius;
  const Quat orientation =
      rotation_from_vector(on.rotation * on.motion.angular_velocity * time) * body.orientation;
  std::int32_t lowest = body.support_hint;
  const double lowest_gap = find_lowest_point(shape, orientation, plane.normal, height, lowest).gap;
  const std::size_t known = found.count;
  const auto add = [&](std::int32_t vertex) {
    const auto vertices = std::span(found.vertex).first(known);
    if (found.count == StepContacts::kCapacity || std::ranges::find(vertices, vertex) != vertices.end())
      return false;
    found.add(vertex_contact(body, kind, world, on.rotation, vertex, plane_index), vertex, plane_index);
    return true;
  };
  if (lowest_gap > deep || !add(lowest)) return 0;
  for (GroundContact& c : std::span(found.contact).first(known)) c.guess = c.impulse();
  const Vec3 normal = orientation.conjugate() * plane.normal;
  for (const std::int32_t next : shape.hull.neighbors(lowest))
    if (height + shape.hull.vertices[std::size_t(next)].dot(normal) < deep) add(next);
  return int(found.count - known);
}

}  // namespace lodestone
