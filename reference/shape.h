// A rigid body's shape, ready for every level: its mesh about the centre of mass, hull, mass distribution and
// content hash.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "reference/hull/hull.h"
#include "reference/hull/tip_map.h"
#include "reference/mesh/mass_properties.h"
#include "reference/mesh/mesh.h"

namespace lodestone {

/// Immutable once made; shared by all bodies of that shape. The body frame has the mesh's axes and its origin
/// at the centre of mass.
struct Shape {
  std::string name;
  Mesh mesh;  ///< vertices relative to the centre of mass
  Hull hull;
  SupportMap support_map;
  TipMap tips;          ///< may be none: then every vertex is looked at
  double volume = 0.0;  ///< m³
  /// m, where the body frame's origin lies in the mesh that was given.
  Vec3 center_of_mass_in_mesh = Vec3::Zero();
  Mat3 inertia_per_mass = Mat3::Identity();  ///< m², body axes
  Mat3 inverse_inertia_per_mass = Mat3::Identity();
  /// m, greatest distance of a vertex from the centre of mass: the paper's bounding sphere.
  double radius = 0.0;
  double inner_radius = 0.0;  ///< m, of the greatest ball about the centre of mass that the hull contains
  double size = 0.0;          ///< m, longest side of the mesh's bounding box
  bool convex = false;        ///< whether mesh and hull bound the same solid
  /// Of a concave shape, whose union it is (convex_pieces.h), each about its own `center_of_mass_in_mesh` in
  /// this body's frame; may be none.
  std::vector<Shape> pieces;
  std::optional<double> sphere_radius;  ///< set where the shape is exactly a sphere
  /// Of geometry and mass distribution over `radius`: equal for scaled copies.
  std::uint64_t content_hash = 0;
};

/// What may be given instead of being measured from the mesh.
struct MassOverride {
  std::optional<Vec3> center_of_mass_m = {};     ///< in the mesh's frame, inside the mesh's hull
  std::optional<Mat3> inertia_per_mass_m2 = {};  ///< about the centre of mass, mesh axes
};

/// Checks, repairs and measures `mesh`. Throws InputError, with `name` at its head, for a mesh that cannot be
/// a solid, an open mesh without a full override, an impossible inertia and a centre of mass outside the
/// hull. A given centre of mass does not change the measured inertia. An open mesh has its hull's volume.
Shape make_shape(std::string name, Mesh mesh, const MassOverride& mass = {}, MeshReport* report = nullptr);
Shape make_sphere_shape(double radius_m);

/// A copy `factor` times as large, of the same density. Throws InputError unless that is positive and finite.
Shape scale_shape(const Shape& shape, double factor);

/// A copy of that radius, made of nothing but what the content hash covers: of all shapes with one hash it is
/// the same to the bit, whatever their sizes. Its vertices lie within 1e-7 R of those of `shape`. No pieces.
Shape make_hashed_copy(const Shape& shape, double radius_m);

/// The well-known bunny of Debian's glmark2-data, its longest side `size_m`, simplified to `faces` faces (the
/// paper's 4,698). Throws InputError naming the package where the file is missing.
Shape make_bunny_shape(double size_m, int faces = 4698);

}  // namespace lodestone
