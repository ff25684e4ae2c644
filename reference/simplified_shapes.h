// Cheaper stand-ins for a mesh: fewer faces (meshoptimizer) and a fitted set of spheres, the baselines of the paper's table 1.
#pragma once

#include <vector>

#include "reference/mesh.h"

namespace lodestone {

struct Sphere {
  Vec3 center = Vec3::Zero();  ///< m
  double radius = 0.0;         ///< m
};

/// `mesh` with at most about `faces` faces; `error_m`, when given, receives the greatest distance moved.
/// Closed stays closed. Throws InputError where that many faces cannot be reached within 10 %.
Mesh simplify_mesh(const Mesh& mesh, int faces, double* error_m = nullptr);

/// `count` spheres that together fill the solid: k-means over points inside it, then each radius chosen so that the union's
/// volume and extent match the solid's best.
std::vector<Sphere> fit_spheres(const Mesh& mesh, int count = 7);

}  // namespace lodestone
