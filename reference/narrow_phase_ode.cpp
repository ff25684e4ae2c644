#include "reference/narrow_phase_ode.h"

#include "reference/geometry_ode.h"

namespace lodestone::ode {
namespace {

// Two trimeshes give the first contacts that they find, not the deepest: room for more than any real touch has.
constexpr int kMostContacts = 512;

bool is_mesh(dGeomID geom) { return dGeomGetClass(geom) == dTriMeshClass; }

Vec3 face_normal(dGeomID mesh, int face) {
  dVector3 corner[3];
  dGeomTriMeshGetTriangle(mesh, face, &corner[0], &corner[1], &corner[2]);
  const Vec3 a = to_vec3(corner[0]);
  return (to_vec3(corner[1]) - a).cross(to_vec3(corner[2]) - a);
}

/// The surface of one body at a contact lies inside the other; after the shift neither point may.
bool still_overlap(dGeomID first, dGeomID second, const ContactPoint& contact, const Vec3& shift, double size) {
  const double reach = 8.0 * size;
  const Vec3 out = shift.normalized();
  return is_inside(second, contact.point + shift, out, reach) || is_inside(first, contact.point - shift, -out, reach);
}

int collide(dGeomID first, dGeomID second, std::vector<dContactGeom>& found) {
  found.resize(kMostContacts);
  return dCollide(first, second, kMostContacts, found.data(), sizeof(dContactGeom));
}

}  // namespace

bool is_inside(dGeomID mesh, const Vec3& point, const Vec3& direction, double reach) {
  const dGeomID ray = dCreateRay(nullptr, reach);
  dGeomRaySet(ray, point.x(), point.y(), point.z(), direction.x(), direction.y(), direction.z());
  dGeomRaySetBackfaceCull(ray, 0);
  dGeomRaySetClosestHit(ray, 1);
  dContactGeom hit;
  const bool met = dCollide(ray, mesh, 1, &hit, sizeof hit) > 0;
  dGeomDestroy(ray);
  return met && face_normal(mesh, hit.side2).dot(direction) > 0.0;
}

void NarrowPhase::find(dGeomID first, dGeomID second, double size, std::vector<ContactPoint>& points) {
  std::unique_lock lock(trimesh_mutex(), std::defer_lock);
  if (is_mesh(first) || is_mesh(second)) lock.lock();
  const int count = collide(first, second, found_);
  const std::size_t before = points.size();
  for (const dContactGeom& contact : std::span(found_).first(count))
    points.push_back({to_vec3(contact.pos), to_vec3(contact.normal), contact.depth});
  if (!is_mesh(first) || !is_mesh(second)) return;
  const auto overlap = [&](const ContactPoint& contact, const Vec3& shift) {
    return still_overlap(first, second, contact, shift, size);
  };
  points.resize(before + filter_contacts(std::span(points).subspan(before), size, overlap));
}

}  // namespace lodestone::ode
