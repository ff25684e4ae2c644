// The shape of a rigid body, with what all rungs need of it: the mesh about its centre of mass, the hull, the
// mass distribution and a content hash.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "reference/hull/hull.h"
#include "reference/hull/tip_map.h"
#include "reference/mesh/mass_properties.h"
#include "reference/mesh/mesh.h"

namespace lodestone {

/// Immutable once made, and shared by all bodies of that shape. The body frame has the mesh's axes, and its
/// origin at the centre of mass.
struct Shape {
  std::string name;
  Mesh mesh;  ///< in the body frame
  Hull hull;  ///< the mesh's convex hull, in the body frame
  SupportMap support_map;
  TipMap tips;          ///< may be empty: then a search looks at every vertex
  double volume = 0.0;  ///< m³
  /// m: where the body frame's origin is in the mesh that was given.
  Vec3 center_of_mass_in_mesh = Vec3::Zero();
  Mat3 inertia_per_mass = Mat3::Identity();          ///< m², about the centre of mass, in the body frame
  Mat3 inverse_inertia_per_mass = Mat3::Identity();  ///< 1/m²
  /// m: the greatest distance of a vertex from the centre of mass (the paper's bounding sphere), R.
  double radius = 0.0;
  double inner_radius = 0.0;  ///< m: of the greatest ball about the centre of mass that the hull contains
  double size = 0.0;          ///< m: the longest side of the mesh's bounding box
  bool convex = false;        ///< whether mesh and hull bound the same solid
  /// Convex pieces whose union a concave shape is (convex_pieces.h); may be empty. Each is in a frame of its
  /// own, whose origin in this body's frame is the piece's `center_of_mass_in_mesh`.
  std::vector<Shape> pieces;
  std::optional<double> sphere_radius;  ///< m, if the shape is exactly a sphere
  /// Of the mesh and the mass distribution over `radius`: the same for scaled copies.
  std::uint64_t content_hash = 0;
};

/// What the caller knows of the mass distribution; what is not given is measured from the mesh.
struct MassOverride {
  std::optional<Vec3> center_of_mass_m = {};     ///< in the mesh's frame; inside the mesh's hull
  std::optional<Mat3> inertia_per_mass_m2 = {};  ///< about the centre of mass, in the mesh's axes
};

/// Checks, repairs (repair_mesh) and measures `mesh`, as a solid of uniform density. Throws InputError, which
/// begins with `name`, for a mesh that cannot be a solid, one that is not MeshReport::closed() unless centre
/// of mass and inertia are both given, a centre of mass outside the hull, and an impossible inertia. A given
/// centre of mass does not change the measured inertia. A mesh that is not closed has the volume of its hull.
Shape make_shape(std::string name, Mesh mesh, const MassOverride& mass = {}, MeshReport* report = nullptr);
/// An exact sphere, named "sphere". Throws InputError unless its diameter is 1e-4 … 1e4 m.
Shape make_sphere_shape(double radius_m);

/// A copy `factor` times as large, of the same content hash. Throws InputError unless `factor` is positive
/// and finite.
Shape scale_shape(const Shape& shape, double factor);

/// A copy of radius `radius_m` (m, > 0), made only from what the content hash covers: for all shapes with the
/// same hash it is the same to the bit, whatever their sizes. Its vertices lie within 1e-7 R of those of
/// `shape`. It has no pieces.
Shape make_hashed_copy(const Shape& shape, double radius_m);

/// The bunny of Debian's package glmark2-data, its longest side `size_m`, simplified to `faces` faces (≥ 4;
/// the paper's 4,698). Throws InputError, which names the package, if the file is missing.
Shape make_bunny_shape(double size_m, int faces = 4698);

}  // namespace lodestone
