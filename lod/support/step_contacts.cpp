#include "lod/support/step_contacts.h"

#include <algorithm>

#include "lod/contact/solid_points.h"

namespace lodestone {

GroundContact point_contact(const StatisticalBody& body, const BodyKind& kind, const StepWorld& world,
                            const Mat3& rotation, const TouchingPoint& point, const HalfSpace& plane) {
  const Vec3 normal = rotation.transpose() * plane.normal;
  const std::optional<double>& ball = kind.shape->sphere_radius;
  const Vec3 arm = ball ? Vec3(-*ball * normal) : point.arm;
  return {.normal = normal,
          .arm = arm,
          .gap = plane.height_of(body.position) + arm.dot(normal),
          .law = world.law(kind, plane)};
}

namespace {

/// A body that looks for the contacts of a step.
struct Seeker {
  StatisticalBody& body;
  const BodyKind& kind;
  const StepWorld& world;
  const OnGround& on;
  double time, least_margin;  // s, m
  const HeldPoints& held;
  StepContacts& found;

  void find_on_plane(const HalfSpace& plane);
  void find_on_solids();

 private:
  Vec3 guess(const TouchingPoint& point) const {
    return on.rotation.transpose() * held.find(point, *kind.shape);
  }
  void add(const GroundContact& contact, const TouchingPoint& point, const HalfSpace& plane) {
    found.add(contact, point, plane);
    if (contact.gap < found.deepest) found.deepest = contact.gap, found.deepest_plane = &plane;
  }
};

void Seeker::find_on_plane(const HalfSpace& plane) {
  if (found.count + kMaxGroundContacts > StepContacts::kCapacity) return;
  const Shape& shape = *kind.shape;
  visit_vertices_near(plane, body, shape, on, time, least_margin,
                      [&](const HullContact& contact, const Vec3& normal) {
                        const TouchingPoint point{contact.vertex, arm_of(contact, shape, normal)};
                        add({.normal = normal,
                             .arm = point.arm,
                             .gap = contact.gap,
                             .law = world.law(kind, plane),
                             .guess = guess(point)},
                            point, plane);
                      });
}

// Of those that many triangles have in common one, and of more than there is room for the nearer ones.
void Seeker::find_on_solids() {
  constexpr double kSame = 1e-3;       // over R
  constexpr double kSameWay = 0.9999;  // cosine
  thread_local SolidPoints near;
  const double radius = kind.shape->radius, same = kSame * radius;
  find_solid_points(body, kind, {*world.solids, world.properties_of(body.owner)}, time, least_margin, near);
  found.until = near.until;
  for (const HalfSpace& face : near.planes)
    if (const HalfSpace* plane = found.keep(face)) ++found.under, find_on_plane(*plane);
  found.uneven = !near.points.empty();
  const std::size_t before = found.count;
  for (const SolidPoint& n : near.points) {
    const Vec3 arm = on.rotation.transpose() * (n.point - body.position);
    bool known = false;
    for (std::size_t i = before; i < found.count && !known; ++i)
      known = (found.point[i].arm - arm).squaredNorm() < same * same &&
              found.plane[i]->normal.dot(n.plane.normal) > kSameWay;
    if (known) continue;
    const HalfSpace* plane = found.is_full() ? nullptr : found.keep(n.plane);
    if (!plane) return;
    const TouchingPoint point{n.vertex, arm};
    GroundContact contact = point_contact(body, kind, world, on.rotation, point, *plane);
    contact.guess = guess(point);
    add(contact, point, *plane);
  }
}

}  // namespace

void find_step_contacts(StatisticalBody& body, const BodyKind& kind, const StepWorld& world,
                        const OnGround& on, double time, double least_margin, const HeldPoints& held,
                        StepContacts& found) {
  found.count = 0;
  found.deepest = 0.0;
  found.uneven = false;
  found.under = 0;
  found.until = time;
  Seeker seeker{body, kind, world, on, time, least_margin, held, found};
  for (const HalfSpace& plane : world.planes) seeker.find_on_plane(plane);
  if (!world.solids) return;
  found.local.reserve(3 * StepContacts::kCapacity);
  found.local.clear();
  seeker.find_on_solids();
}

int add_sinking(const StatisticalBody& body, const BodyKind& kind, const StepWorld& world, const OnGround& on,
                double time, StepContacts& found) {
  const Shape& shape = *kind.shape;
  if (shape.sphere_radius || found.uneven) return 0;
  const HalfSpace& plane = *found.plane[found.count - 1];
  const double height = plane.height_of(body.position + on.rotation * on.motion.velocity * time),
               deep = -kTouching * shape.radius;
  const Quat orientation =
      rotation_from_vector(on.rotation * on.motion.angular_velocity * time) * body.orientation;
  std::int32_t lowest = body.support_hint;
  const double lowest_gap = find_lowest_point(shape, orientation, plane.normal, height, lowest).gap;
  const std::size_t known = found.count;
  const auto add = [&](std::int32_t vertex) {
    const auto points = std::span(found.point).first(known);
    if (found.is_full() || std::ranges::find(points, vertex, &TouchingPoint::vertex) != points.end())
      return false;
    const TouchingPoint point{vertex, shape.hull.vertices[std::size_t(vertex)]};
    found.add(point_contact(body, kind, world, on.rotation, point, plane), point, plane);
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
