#include "lod/contact/solid_contacts.h"

#include <algorithm>
#include <limits>

namespace lodestone {
namespace {

constexpr double kTouching = 0.01;  // over R: near enough to carry, as between bodies

PairBody pair_body(const StaticSolid& solid) { return {solid.shape.get(), solid.position, solid.orientation}; }

Vec3 middle_of(const Manifold& manifold) {
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < manifold.count; ++i) sum += manifold.points[i].point;
  return sum / manifold.count;
}

// The edge of the triangle that `point` is nearest to, or farthest beyond.
std::size_t nearest_edge(const SurfaceTriangle& t, const Vec3& point) {
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 inward = t.normal.cross(t.corner[(i + 1) % 3] - t.corner[i]).normalized();
    const double distance = inward.dot(point - t.corner[i]);
    if (distance < least) least = distance, nearest = i;
  }
  return nearest;
}

std::optional<PairContact> meet(const PairBody& body, const StaticSolid& solid, double margin) {
  const PairBody ground = pair_body(solid);
  std::optional<PairContact> contact = find_hull_contact(body, ground, margin);
  if (!contact || !solid.surface) return contact;
  const SurfaceTriangle& t = *solid.surface;
  const double along = contact->normal.dot(t.normal);
  const bool over_ridge = along > 0.0 && along < 0.999 && t.ridge[nearest_edge(t, middle_of(contact->manifold))];
  return over_ridge ? contact : find_contact_along(body, ground, t.normal, margin);
}

// Whether the contact closes within `time`.
bool closes(const PairContact& contact, const StatisticalBody& body, const Vec3& omega, double touching, double time) {
  const auto points = std::span(contact.manifold.points).first(std::size_t(contact.manifold.count));
  return std::ranges::any_of(points, [&](const ManifoldPoint& p) {
    const Vec3 velocity = body.velocity + omega.cross(p.point - body.position);
    return p.gap + velocity.dot(contact.normal) * time <= touching;
  });
}

}  // namespace

std::optional<HalfSpace> find_face_below(const StaticSolid& solid, const Vec3& center, double reach) {
  if (solid.surface) return {};  // its neighbours may rise beside it
  const Vec3 in_solid = solid.orientation.conjugate() * (center - solid.position);
  std::optional<HalfSpace> face;
  for (const Vec3& normal : solid.face_normals) {
    const double offset = solid.shape->hull.vertices[find_support(solid.shape->hull, normal)].dot(normal), height = normal.dot(in_solid) - offset;
    if (height <= -reach) continue;
    if (height < 0.0 || face) return {};
    const Vec3 up = solid.orientation * normal;
    face = HalfSpace{up, offset + up.dot(solid.position), solid.material};
  }
  return face;
}

void find_solid_contacts(const StatisticalBody& body, const BodyKind& kind, std::int32_t slot, const StaticSolids& solids, double time,
                         std::vector<SolidContact>& found, std::vector<HalfSpace>& planes) {
  const Shape& shape = *kind.shape;
  const Vec3 omega = angular_velocity(body.orientation, body.spin, shape);
  const double touching = kTouching * shape.radius, way = (body.velocity.norm() + omega.norm() * shape.radius) * time;
  thread_local std::vector<int> near;
  near.clear();
  solids.find_near(body.position, shape.radius + touching + way, near);
  std::ranges::sort(near);
  const auto face_below = [&](int i) { return find_face_below(solids[i], body.position, shape.radius + touching + way); };
  if (std::ranges::all_of(near, [&](int i) { return face_below(i).has_value(); })) {
    for (const int i : near) planes.push_back(*face_below(i));
    return;
  }
  const PairBody self{&shape, body.position, body.orientation};
  for (const int i : near)
    if (const auto contact = meet(self, solids[i], touching + way); contact && closes(*contact, body, omega, touching, time)) found.push_back({slot, i, *contact});
}

}  // namespace lodestone
