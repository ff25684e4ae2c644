#include "reference/ode/geom_shape.h"

#include <memory>

#include "reference/error.h"
#include "reference/hull/hull.h"
#include "reference/ode/geometry_ode.h"

namespace lodestone {

using namespace ode;

namespace {

// A convex keeps its corners to itself, but its contacts with a plane are those of them that are below: a
// plane through its middle and the same one turned round give all of them.
std::vector<Vec3> corners_of(dGeomID convex) {
  constexpr int kMost = 0xffff;  // as many as dCollide can give

  const auto found = std::make_unique_for_overwrite<dContactGeom[]>(kMost);  // megabytes: not set to 0
  dReal b[6];
  dGeomGetAABB(convex, b);
  const double middle = 0.5 * (b[4] + b[5]);
  const Vec3 place = to_vec3(dGeomGetPosition(convex));
  dQuaternion q;
  dGeomGetQuaternion(convex, q);
  std::vector<Vec3> corners;
  for (const double side : {1.0, -1.0}) {
    const dGeomID plane = dCreatePlane(nullptr, 0, 0, side, side * middle);
    const int count = dCollide(convex, plane, kMost, found.get(), sizeof(dContactGeom));
    dGeomDestroy(plane);
    for (int i = 0; i < count; ++i)
      corners.push_back(to_quat(q).conjugate() * (to_vec3(found[i].pos) - place));
  }
  return corners;
}

void read_convex(dGeomID geom, GeomShape& shape) {
  try {
    Hull hull = make_hull(corners_of(geom));
    shape.vertices = std::move(hull.vertices), shape.faces = std::move(hull.faces);
  } catch (const InputError&) {  // flat: there is no solid to read
    shape.kind = GeomKind::convex;
  }
}

// By another geom of its data, at the origin: ODE gives a geom's triangles in the world, and the way back
// from there would leave what it rounds.
void read_trimesh(dGeomID geom, GeomShape& shape) {
  const dGeomID own = dCreateTriMesh(nullptr, dGeomTriMeshGetData(geom), nullptr, nullptr, nullptr);
  const int count = dGeomTriMeshGetTriangleCount(own);
  for (int i = 0; i < count; ++i) {
    dVector3 corner[3];
    dGeomTriMeshGetTriangle(own, i, &corner[0], &corner[1], &corner[2]);
    for (const auto& c : corner) shape.vertices.push_back(to_vec3(c));
    shape.faces.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  dGeomDestroy(own);
}

}  // namespace

GeomKind kind_of(dxGeom* geom) {
  switch (dGeomGetClass(geom)) {
    case dPlaneClass:
      return GeomKind::plane;
    case dSphereClass:
      return GeomKind::sphere;
    case dBoxClass:
      return GeomKind::box;
    case dCapsuleClass:
      return GeomKind::capsule;
    case dCylinderClass:
      return GeomKind::cylinder;
    case dConvexClass:
      return GeomKind::convex;
    case dTriMeshClass:
      return GeomKind::trimesh;
    case dHeightfieldClass:
      return GeomKind::height_field;
    default:
      return GeomKind::other;
  }
}

GeomShape read_geom(dxGeom* geom) {
  prepare();
  GeomShape shape{.kind = kind_of(geom)};
  dVector3 sides;
  switch (shape.kind) {
    case GeomKind::sphere:
      shape.radius = dGeomSphereGetRadius(geom);
      break;
    case GeomKind::box:
      dGeomBoxGetLengths(geom, sides);
      shape.sides = to_vec3(sides);
      break;
    case GeomKind::capsule:
      dGeomCapsuleGetParams(geom, &shape.radius, &shape.length);
      break;
    case GeomKind::cylinder:
      dGeomCylinderGetParams(geom, &shape.radius, &shape.length);
      break;
    case GeomKind::convex:
      read_convex(geom, shape);
      break;
    case GeomKind::trimesh:
      read_trimesh(geom, shape);
      break;
    case GeomKind::plane:
    case GeomKind::height_field:
    case GeomKind::other:
      break;
  }
  return shape;
}

struct GeomProbe::Impl {
  dGeomID ray = dCreateRay(nullptr, 1.0), mesh = dCreateTriMesh(nullptr, nullptr, nullptr, nullptr, nullptr);
  Impl() {
    dGeomRaySetClosestHit(ray, 1);
    dGeomRaySetBackfaceCull(ray, 0);
  }
  ~Impl() {
    dGeomDestroy(ray);
    dGeomDestroy(mesh);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
};

GeomProbe::GeomProbe() {
  prepare();
  impl_ = std::make_unique<Impl>();
}

GeomProbe::~GeomProbe() = default;

std::optional<RayHit> GeomProbe::cast(dxGeom* geom, const Vec3& from, const Vec3& direction, double length) {
  const bool is_mesh = dGeomGetClass(geom) == dTriMeshClass;
  Vec3 origin = Vec3::Zero();
  std::unique_lock lock(trimesh_mutex(), std::defer_lock);
  if (is_mesh) {
    // OPCODE computes in float: about the start of the ray it is as precise far from the world's origin as
    // near it.
    lock.lock();
    origin = from;
    const Vec3 place = to_vec3(dGeomGetPosition(geom)) - origin;
    dGeomTriMeshSetData(impl_->mesh, dGeomTriMeshGetData(geom));
    dGeomSetPosition(impl_->mesh, place.x(), place.y(), place.z());
    dGeomSetRotation(impl_->mesh, dGeomGetRotation(geom));
  }
  const Vec3 start = from - origin;
  dGeomRaySetLength(impl_->ray, length);
  dGeomRaySet(impl_->ray, start.x(), start.y(), start.z(), direction.x(), direction.y(), direction.z());
  dContactGeom hit;
  if (dCollide(impl_->ray, is_mesh ? impl_->mesh : geom, 1, &hit, sizeof hit) == 0) return std::nullopt;
  const Vec3 normal = to_vec3(hit.normal);
  return RayHit{origin + to_vec3(hit.pos), normal.dot(direction) > 0.0 ? Vec3(-normal) : normal, hit.depth};
}

}  // namespace lodestone
