#include "reference/ode/geom_identity_ode.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "reference/ode/geometry_ode.h"

namespace lodestone::ode {
namespace {

/// Four sums side by side, as each waits for its last product. A change of one word always changes it.
class Fingerprint {
 public:
  void add(std::uint64_t word) {
    std::uint64_t& sum = sums_[next_++ % sums_.size()];
    sum = std::rotl((sum ^ word) * kOdd, 29);
  }
  void add(double number) { add(std::bit_cast<std::uint64_t>(number)); }
  void add(const void* pointer) { add(std::uint64_t(reinterpret_cast<std::uintptr_t>(pointer))); }
  std::uint64_t value() const {
    std::uint64_t all = 0;
    for (const std::uint64_t sum : sums_) all = std::rotl((all ^ sum) * kOdd, 29);
    return all;
  }

 private:
  static constexpr std::uint64_t kOdd = 0x9e3779b97f4a7c15u;
  std::array<std::uint64_t, 4> sums_{1, 2, 3, 4};
  unsigned next_ = 0;
};

std::array<dReal, 4> sizes_of(dGeomID geom, int geom_class) {
  std::array<dReal, 4> sizes{};
  switch (geom_class) {
    case dSphereClass:
      sizes[0] = dGeomSphereGetRadius(geom);
      break;
    case dBoxClass:
      dGeomBoxGetLengths(geom, sizes.data());
      break;
    case dCapsuleClass:
      dGeomCapsuleGetParams(geom, &sizes[0], &sizes[1]);
      break;
    case dCylinderClass:
      dGeomCylinderGetParams(geom, &sizes[0], &sizes[1]);
      break;
    case dPlaneClass:
      dGeomPlaneGetParams(geom, sizes.data());
      break;
    default:
      break;
  }
  sizes[3] = geom_class == dPlaneClass ? sizes[3] : 0.0;  // a box's fourth is ODE's padding
  return sizes;
}

// What a trimesh or a height field has its form from.
const void* data_of(dGeomID geom, int geom_class) {
  if (geom_class == dTriMeshClass) return dGeomTriMeshGetData(geom);
  return geom_class == dHeightfieldClass ? dGeomHeightfieldGetHeightfieldData(geom) : nullptr;
}

std::array<dReal, 7> offset_of(dGeomID geom) {
  std::array<dReal, 7> offset{};
  std::copy_n(dGeomGetOffsetPosition(geom), 3, offset.begin());
  dQuaternion turn;
  dGeomGetOffsetQuaternion(geom, turn);
  std::copy_n(turn, 4, offset.begin() + 3);
  return offset;
}

}  // namespace

bool is_spoilt(dGeomID geom, int geom_class, bool placeable) {
  const auto sum = [](const dReal* v) { return v[0] + v[1] + v[2]; };
  const std::array<dReal, 4> sizes = sizes_of(geom, geom_class);
  dReal all = sum(sizes.data()) + sizes[3];
  if (!placeable) return !std::isfinite(all);
  all += sum(dGeomGetPosition(geom));
  const dReal* rotation = dGeomGetRotation(geom);
  for (const int row : {0, 4, 8}) all += sum(rotation + row);
  if (const dBodyID body = dGeomGetBody(geom))
    all += sum(dBodyGetLinearVel(body)) + sum(dBodyGetAngularVel(body));
  return !std::isfinite(all);
}

GeomIdentity geom_identity_of(dGeomID geom, int geom_class, unsigned category, unsigned collide,
                              std::uint64_t content) {
  const dBodyID body = dGeomGetBody(geom);
  const bool dynamic = body && !dBodyIsKinematic(body);
  return {.geom = geom,
          .body = body,
          .geom_class = geom_class,
          .dynamic = dynamic,
          .category = category,
          .collide = collide,
          .sizes = sizes_of(geom, geom_class),
          .offset = dynamic ? offset_of(geom) : std::array<dReal, 7>{},
          .data = data_of(geom, geom_class),
          .content = content};
}

GeomPose geom_pose_of(dGeomID geom, bool placeable) {
  GeomPose pose;
  dGeomGetAABB(geom, pose.bounds.data());
  if (!placeable) return pose;
  std::copy_n(dGeomGetPosition(geom), 3, pose.position.begin());
  std::copy_n(dGeomGetRotation(geom), 12, pose.rotation.begin());
  return pose;
}

bool is_reshaped(const GeomPose& before, const GeomPose& now) {
  return before.position == now.position && before.rotation == now.rotation && before.bounds != now.bounds;
}

// The bounds of the first few follow from their place and sizes.
std::uint64_t fingerprint_of(dGeomID geom, int geom_class, bool placeable, unsigned category,
                             unsigned collide, std::uint64_t content) {
  Fingerprint print;
  const dBodyID body = dGeomGetBody(geom);
  print.add(body);
  print.add(std::uint64_t(geom_class) << 1 | (body && !dBodyIsKinematic(body)));
  print.add(std::uint64_t(category) << 32 | collide);
  for (const dReal size : sizes_of(geom, geom_class)) print.add(size);
  if (geom_class == dPlaneClass) return print.value();
  if (placeable) {
    const dReal *position = dGeomGetPosition(geom), *rotation = dGeomGetRotation(geom);
    for (const int i : {0, 1, 2}) print.add(position[i]);
    for (const int i : {0, 1, 2, 4, 5, 6, 8, 9, 10}) print.add(rotation[i]);
  }
  if (geom_class == dSphereClass || geom_class == dBoxClass || geom_class == dCapsuleClass ||
      geom_class == dCylinderClass)
    return print.value();
  print.add(data_of(geom, geom_class)), print.add(content);
  std::array<dReal, 6> bounds;
  dGeomGetAABB(geom, bounds.data());
  for (const dReal side : bounds) print.add(side);
  return print.value();
}

// A mesh that a caller makes after destroying another often has all its addresses. The first triangle, the
// last and some between tell the two apart.
std::uint64_t content_of(dGeomID mesh, dGeomID probe) {
  constexpr int kSamples = 4;
  dGeomTriMeshSetData(probe, dGeomTriMeshGetData(mesh));
  const int count = dGeomTriMeshGetTriangleCount(probe);
  Fingerprint print;
  print.add(std::uint64_t(count));
  for (int i = 0; i < std::min(kSamples, count); ++i) {
    std::array<dVector3, 3> corners;
    dGeomTriMeshGetTriangle(probe, int(std::int64_t(count - 1) * i / std::max(1, kSamples - 1)), &corners[0],
                            &corners[1], &corners[2]);
    for (const dVector3& corner : corners)
      for (const int axis : {0, 1, 2}) print.add(corner[axis]);
  }
  return print.value();
}

}  // namespace lodestone::ode
