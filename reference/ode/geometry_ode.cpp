#include "reference/ode/geometry_ode.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "reference/error.h"

namespace lodestone::ode {
namespace {

void check_faces(std::span<const Vec3> vertices, std::span<const std::array<int, 3>> faces) {
  // A single triangle against another mesh makes OPCODE crash, and it takes indices out of range silently.
  if (faces.size() < 2)
    throw InputError(fmt::format("a trimesh: found {} faces, expected two or more", faces.size()));
  for (const Vec3& vertex : vertices)
    if (!vertex.allFinite())
      throw InputError(fmt::format("a trimesh: found a vertex at ({}, {}, {}), expected finite ones",
                                   vertex.x(), vertex.y(), vertex.z()));
  for (const auto& face : faces)
    for (const int i : face)
      if (i < 0 || i >= int(vertices.size()))
        throw InputError(fmt::format("a trimesh: found a face of vertex {}, expected 0 … {}", i,
                                     int(vertices.size()) - 1));
}

Sphere sphere_of_volume(const Shape& shape) {
  const double radius = shape.sphere_radius.value_or(std::cbrt(shape.volume * 0.75 / std::numbers::pi));
  return {Vec3::Zero(), radius};
}

/// Its bounding box's, m; aborts unless the centre of mass is in the middle.
Vec3 sides_of(const Shape& shape) {
  Eigen::AlignedBox3d bounds;
  for (const Vec3& vertex : shape.hull.vertices) bounds.extend(vertex);
  check_that(bounds.center().norm() <= 1e-9 * shape.size,
             "a box primitive's centre of mass is in its middle");
  return bounds.sizes();
}

dGeomID make_box_or_mesh(dSpaceID space, const OdeBodyDefinition& definition, TrimeshCache& cache) {
  if (definition.geometry == OdeGeometry::box) {
    const Vec3 sides = sides_of(*definition.shape);
    return dCreateBox(space, sides.x(), sides.y(), sides.z());
  }
  const auto data = definition.geometry == OdeGeometry::hull ? cache.hull_of(definition.shape)
                                                             : cache.mesh_of(definition.shape);
  return dCreateTriMesh(space, data, nullptr, nullptr, nullptr);
}

}  // namespace

TrimeshData::TrimeshData(std::span<const Vec3> vertices, std::span<const std::array<int, 3>> faces) {
  check_faces(vertices, faces);
  for (const Vec3& v : vertices)
    vertices_.insert(vertices_.end(), {float(v.x()), float(v.y()), float(v.z())});
  for (const auto& f : faces)
    indices_.insert(indices_.end(), {dTriIndex(f[0]), dTriIndex(f[1]), dTriIndex(f[2])});
  id_ = dGeomTriMeshDataCreate();
  dGeomTriMeshDataBuildSingle(id_, vertices_.data(), 3 * sizeof(float), int(vertices.size()), indices_.data(),
                              int(indices_.size()), 3 * sizeof(dTriIndex));
}

TrimeshData::~TrimeshData() { dGeomTriMeshDataDestroy(id_); }

// ODE ends the process where it is asked for them twice.
void TrimeshData::prepare_for_convexes() {
  if (std::exchange(knows_angles_, true)) return;
  dGeomTriMeshDataPreprocess2(id_, 1u << dTRIDATAPREPROCESS_BUILD_FACE_ANGLES, nullptr);
}

void TrimeshCache::prepare_for_convexes(const Shape& shape, dTriMeshDataID data) {
  for (Entries* const entries : {&meshes_, &hulls_})
    if (const auto known = entries->find(&shape); known != entries->end() && known->second.data->id() == data)
      known->second.data->prepare_for_convexes();
}

dTriMeshDataID TrimeshCache::find(Entries& entries, const std::shared_ptr<const Shape>& shape,
                                  std::span<const Vec3> vertices, std::span<const std::array<int, 3>> faces) {
  if (const auto known = entries.find(shape.get()); known != entries.end()) return known->second.data->id();
  if (meshes_.size() + hulls_.size() >= most_) drop_unused();
  ++built_;
  Entry made{shape, std::make_unique<TrimeshData>(vertices, faces)};
  return entries.emplace(shape.get(), std::move(made)).first->second.data->id();
}

// A body that has one of these in its geom has the shape, too.
void TrimeshCache::drop_unused() {
  const auto is_used = [this](const std::shared_ptr<const Shape>& shape) {
    return shape.use_count() > long(meshes_.count(shape.get()) + hulls_.count(shape.get()));
  };
  for (Entries* const entries : {&meshes_, &hulls_})
    std::erase_if(*entries, [&](const auto& known) { return !is_used(known.second.shape); });
  most_ = std::max(most_, 2 * (meshes_.size() + hulls_.size()));
}

std::vector<Sphere> spheres_of(const OdeBodyDefinition& definition) {
  const Shape& shape = *definition.shape;
  if (shape.sphere_radius || definition.geometry == OdeGeometry::sphere) return {sphere_of_volume(shape)};
  if (definition.geometry != OdeGeometry::spheres) return {};
  check_that(!definition.spheres.empty(), "OdeGeometry::spheres comes with spheres");
  return {definition.spheres.begin(), definition.spheres.end()};
}

void make_geoms(dSpaceID space, dBodyID body, const OdeBodyDefinition& definition,
                std::span<const Sphere> spheres, TrimeshCache& cache) {
  if (spheres.empty()) dGeomSetBody(make_box_or_mesh(space, definition, cache), body);
  std::uintptr_t ordinal = 0;
  for (const Sphere& sphere : spheres) {
    const dGeomID geom = dCreateSphere(space, sphere.radius);
    dGeomSetBody(geom, body);
    if (!sphere.center.isZero(0.0))
      dGeomSetOffsetPosition(geom, sphere.center.x(), sphere.center.y(), sphere.center.z());
    dGeomSetData(geom, reinterpret_cast<void*>(ordinal++));
  }
}

}  // namespace lodestone::ode
