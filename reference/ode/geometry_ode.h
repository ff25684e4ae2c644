// Collision geometry for ODE: trimesh data shared by every body of a shape, and a body's geoms.
#pragma once

#include <memory>
#include <unordered_map>
#include <vector>

#include "reference/ode/ode_world.h"
#include "reference/ode/runtime_ode.h"

namespace lodestone::ode {

/// ODE's trimesh data with the arrays that it refers to (it copies nothing). OPCODE keeps its vertices in
/// float whatever it is given, so float is what is stored.
class TrimeshData {
 public:
  TrimeshData(std::span<const Vec3> vertices, std::span<const std::array<int, 3>> faces);
  ~TrimeshData();
  TrimeshData(const TrimeshData&) = delete;
  TrimeshData& operator=(const TrimeshData&) = delete;
  dTriMeshDataID id() const { return id_; }
  /// Of the angles between its faces, without which ODE fails an assertion where a convex meets it.
  void prepare_for_convexes();

 private:
  std::vector<float> vertices_;
  std::vector<dTriIndex> indices_;
  dTriMeshDataID id_;
  bool knows_angles_ = false;
};

/// The trimesh data of each shape and of each shape's hull, built on first use, and kept while bodies have
/// the shape.
class TrimeshCache {
 public:
  dTriMeshDataID mesh_of(const std::shared_ptr<const Shape>& shape) {
    return find(meshes_, shape, shape->mesh.vertices, shape->mesh.faces);
  }
  dTriMeshDataID hull_of(const std::shared_ptr<const Shape>& shape) {
    return find(hulls_, shape, shape->hull.vertices, shape->hull.faces);
  }
  /// What `data` is of those of the shape's.
  void prepare_for_convexes(const Shape& shape, dTriMeshDataID data);
  std::int64_t built() const { return built_; }  ///< so far

 private:
  struct Entry {
    std::shared_ptr<const Shape> shape;  // keeps the key from being reused
    std::unique_ptr<TrimeshData> data;
  };
  using Entries = std::unordered_map<const Shape*, Entry>;
  dTriMeshDataID find(Entries& entries, const std::shared_ptr<const Shape>& shape,
                      std::span<const Vec3> vertices, std::span<const std::array<int, 3>> faces);
  void drop_unused();

  Entries meshes_, hulls_;
  std::int64_t built_ = 0;
  std::size_t most_ = 64;  // until those that are no longer used are looked for
};

/// The spheres that stand for a body, about its centre of mass: those given for OdeGeometry::spheres, one for
/// OdeGeometry::sphere (of the shape's volume) and for a shape that is a sphere; none where the body is a
/// mesh.
std::vector<Sphere> spheres_of(const OdeBodyDefinition& definition);

/// Adds to `space` the geoms of `body` and numbers them (dGeomGetData) from zero.
void make_geoms(dSpaceID space, dBodyID body, const OdeBodyDefinition& definition,
                std::span<const Sphere> spheres, TrimeshCache& cache);

inline Vec3 to_vec3(const dReal* v) { return {v[0], v[1], v[2]}; }
inline Quat to_quat(const dReal* q) { return {q[0], q[1], q[2], q[3]}; }

}  // namespace lodestone::ode
