// Cheaper stand-ins for a mesh: fewer faces (meshoptimizer) and a fitted set of spheres, the baselines of the
// paper's table 1.
#pragma once

#include <vector>

#include "reference/mesh/mesh.h"

namespace lodestone {

struct Sphere {
  Vec3 center = Vec3::Zero();  ///< m
  double radius = 0.0;         ///< m
};

/// `mesh` with `faces` faces or just under, where it has more; `error_m`, when given, receives the root mean
/// square distance of the worst vertex from the planes that it replaces. Closed stays closed, scaled copies
/// simplify alike, and the vertices are some of `mesh`'s (to rounding). Throws InputError where so few cannot
/// be reached within 10 % (an open or many-pieced mesh), and for fewer than 4.
Mesh simplify_mesh(const Mesh& mesh, int faces, double* error_m = nullptr);

/// `count` spheres that together fill the solid: k-means over points inside it, then each radius chosen so
/// that the union's volume and extent match the solid's best. The same mesh always gives the same spheres.
/// Throws InputError for a mesh without an inside.
std::vector<Sphere> fit_spheres(const Mesh& mesh, int count = 7);

}  // namespace lodestone
