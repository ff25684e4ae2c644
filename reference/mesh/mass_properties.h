// Volume, centre of mass and inertia of a closed mesh: exact sums over the signed tetrahedra between its
// faces and a point (Blow and Binstock, How to find the inertia tensor (or other mass properties) of a 3D
// solid body represented by a triangle mesh, 2004).
#pragma once

#include "reference/mesh/mesh.h"

namespace lodestone {

struct MassProperties {
  double volume = 0.0;                       ///< m³
  Vec3 center_of_mass = Vec3::Zero();        ///< m, in the mesh's frame
  Mat3 inertia_per_mass = Mat3::Identity();  ///< m², about the centre of mass, in the mesh's axes
};

/// Of a solid of uniform density bounded by `mesh` (closed, outward faces). An open mesh gives a meaningless
/// value: check MeshReport::closed() first. One without volume has its bounding box's middle and no inertia.
MassProperties measure_mass_properties(const Mesh& mesh);

/// Whether `inertia_per_mass` can belong to a rigid body: symmetric, positive definite, I1 + I2 ≥ I3 for its
/// eigenvalues within a relative 1e-9.
bool is_possible_inertia(const Mat3& inertia_per_mass);

}  // namespace lodestone
