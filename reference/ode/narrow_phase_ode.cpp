#include "reference/ode/narrow_phase_ode.h"

#include <algorithm>
#include <functional>

#include "reference/ode/geometry_ode.h"

namespace lodestone::ode {
namespace {

// ODE gives the first contacts that it finds, not the deepest: room for more than any real touch has.
constexpr int kMostContacts = 512;
constexpr double kWithin = 0.01;   // × size
constexpr int kMostFiltered = 64;  // of those, well spread, are looked at twice

bool is_mesh(dGeomID geom) { return dGeomGetClass(geom) == dTriMeshClass; }

bool is_sphere(dGeomID geom) { return dGeomGetClass(geom) == dSphereClass; }

/// ODE finds for each triangle the place nearest to the sphere's centre, but calls the triangle's normal the
/// contact's: where an edge or a corner is nearest, that way out is not towards the centre. Of places none of
/// which lies above another's tangent plane only the nearest touches. Returns how many contacts, put first,
/// are left. `side`: of normals that point into the sphere.
std::size_t mend_sphere_contacts(dGeomID sphere, double side, std::span<ContactPoint> contacts) {
  const Vec3 center = to_vec3(dGeomGetPosition(sphere));
  const double radius = dGeomSphereGetRadius(sphere), least = 1e-6 * radius;
  for (ContactPoint& contact : contacts) {
    const Vec3 out = center - contact.point;
    const double distance = out.norm();
    if (distance < least || out.dot(side * contact.normal) <= 0.0) continue;  // the centre is inside
    contact.normal = side / distance * out;
    contact.depth = radius - distance;
  }
  std::ranges::stable_sort(contacts, std::greater(), &ContactPoint::depth);
  std::size_t kept = 0;
  for (const ContactPoint& contact : contacts) {
    const auto rises_over = [&](const ContactPoint& other) {
      return side * other.normal.dot(contact.point - other.point) > 1e-3 * radius;
    };
    if (contact.depth >= 0.0 && std::ranges::all_of(contacts.first(kept), rises_over))
      contacts[kept++] = contact;
  }
  return kept;
}

/// Outward.
Vec3 face_normal(dGeomID mesh, int face) {
  dVector3 corner[3];
  dGeomTriMeshGetTriangle(mesh, face, &corner[0], &corner[1], &corner[2]);
  const Vec3 a = to_vec3(corner[0]);
  return (to_vec3(corner[1]) - a).cross(to_vec3(corner[2]) - a).normalized();
}

}  // namespace

NarrowPhase::NarrowPhase(bool filtered, int most_measures)
    : found_(kMostContacts),
      ray_(dCreateRay(nullptr, 1.0)),
      filtered_(filtered),
      most_measures_(most_measures) {
  for (dGeomID& geom : local_) geom = dCreateTriMesh(nullptr, nullptr, nullptr, nullptr, nullptr);
  dGeomRaySetBackfaceCull(ray_, 0);
  dGeomRaySetClosestHit(ray_, 1);
}

NarrowPhase::~NarrowPhase() {
  for (const dGeomID geom : local_) dGeomDestroy(geom);
  dGeomDestroy(ray_);
}

void NarrowPhase::find(dGeomID first, dGeomID second, double size, std::vector<ContactPoint>& points) {
  std::unique_lock lock(trimesh_mutex(), std::defer_lock);
  if (is_mesh(first) || is_mesh(second)) lock.lock();
  if (is_mesh(first) && is_mesh(second)) return find_of_meshes(first, second, size, points);
  const int count = dCollide(first, second, kMostContacts, found_.data(), sizeof(dContactGeom));
  const std::size_t before = points.size();
  for (const dContactGeom& contact : std::span(found_).first(count))
    points.push_back({to_vec3(contact.pos), to_vec3(contact.normal), contact.depth});
  if (is_sphere(first) && is_mesh(second))
    points.resize(before + mend_sphere_contacts(first, 1.0, std::span(points).subspan(before)));
  else if (is_mesh(first) && is_sphere(second))
    points.resize(before + mend_sphere_contacts(second, -1.0, std::span(points).subspan(before)));
}

void NarrowPhase::find_of_meshes(dGeomID first, dGeomID second, double size,
                                 std::vector<ContactPoint>& points) {
  size_ = size;
  dGeomRaySetLength(ray_, 16.0 * size);
  const int count = collide_meshes(first, second);
  if (count == 0) return;
  const std::size_t before = points.size();
  for (const dContactGeom& contact : std::span(found_).first(count))
    points.push_back({to_vec3(contact.pos), to_vec3(contact.normal), contact.depth});
  const auto found = std::span(points).subspan(before);
  if (filtered_ && !plainly_believable(found, size)) {
    const auto few = found.first(reduce_contacts(found, kMostFiltered, size));
    const auto measure = [&](const Vec3& place, const Vec3& direction, double longest) {
      return measure_way_out(place, direction, longest);
    };
    points.resize(before + filter_contacts(few, size, measure, most_measures_));
  }
  for (ContactPoint& point : std::span(points).subspan(before)) {
    point.point += origin_;
    point.depth -= kRestingDepth * size;
  }
}

std::optional<WayOut> NarrowPhase::measure_way_out(const Vec3& place, const Vec3& direction,
                                                   double longest) const {
  const auto second = find_exit(1, place, direction);
  if (!second) return {};
  const double least = second->distance - kWithin * size_;  // the first's may be as far behind the place
  if (least > longest) return WayOut{least, second->normal, {}};
  const auto first = find_exit(0, place, -direction);
  if (!first) return {};
  return WayOut{std::max(0.0, second->distance + first->distance), second->normal, -first->normal};
}

/// ODE tells contacts apart by a hash of their places, in rows of four, and fails an assertion where a row
/// overflows and one of its contacts cancels another. About another origin the same contacts hash otherwise;
/// few contacts never overflow a row.
int NarrowPhase::collide_meshes(dGeomID first, dGeomID second) {
  Vec3 origin = to_vec3(dGeomGetPosition(first));
  for (const int most : {kMostContacts, kMostContacts, kMostContacts, kMostContacts / 16}) {
    place(first, second, origin);
    try {
      const RecoverableScope scope;
      return dCollide(local_[0], local_[1], most, found_.data(), sizeof(dContactGeom));
    } catch (const AssertionFailed&) {
      origin += Vec3::Constant(0.01);
    }
  }
  return 0;
}

// OPCODE computes in float: about the first body's own place it is as precise far from the world's origin as
// near it.
void NarrowPhase::place(dGeomID first, dGeomID second, const Vec3& origin) {
  origin_ = origin;
  for (int i = 0; i < 2; ++i) {
    const dGeomID geom = i == 0 ? first : second;
    const Vec3 position = to_vec3(dGeomGetPosition(geom)) - origin;
    dGeomTriMeshSetData(local_[i], dGeomTriMeshGetData(geom));
    dGeomSetPosition(local_[i], position.x(), position.y(), position.z());
    dGeomSetRotation(local_[i], dGeomGetRotation(geom));
  }
}

/// Where a ray from `place` leaves one of the two solids. Surfaces that touch have nothing between them to
/// stand in, so the ray starts a little way inside the body, found towards its centre, away from the other's,
/// or, behind a concave surface, away from its own.
std::optional<NarrowPhase::Exit> NarrowPhase::find_exit(int which, const Vec3& place,
                                                        const Vec3& direction) const {
  const Vec3 to_own = to_vec3(dGeomGetPosition(local_[which])) - place,
             from_other = place - to_vec3(dGeomGetPosition(local_[1 - which]));
  for (const Vec3& inward : {to_own, from_other, Vec3(-to_own)}) {
    const Vec3 offset = kWithin * size_ * inward.normalized();
    if (auto exit = cast_ray(local_[which], place + offset, direction)) {
      exit->distance += offset.dot(direction);
      return exit;
    }
  }
  return {};
}

/// Nothing where `point` is outside of the solid `mesh`, as far as the first face met tells.
std::optional<NarrowPhase::Exit> NarrowPhase::cast_ray(dGeomID mesh, const Vec3& point,
                                                       const Vec3& direction) const {
  dGeomRaySet(ray_, point.x(), point.y(), point.z(), direction.x(), direction.y(), direction.z());
  dContactGeom hit;
  if (dCollide(ray_, mesh, 1, &hit, sizeof hit) == 0) return {};
  const Exit exit{hit.depth, face_normal(mesh, hit.side2)};
  return exit.normal.dot(direction) > 0.0 ? std::optional(exit) : std::nullopt;
}

}  // namespace lodestone::ode
