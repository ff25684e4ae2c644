// What bodies of a kind share, as floats in dense arrays for the loops over bodies.
#pragma once

#include <vector>

#include "lod/statistical/kinds.h"

namespace lodestone {

inline constexpr int kHeightSamples = 64;  // of the collision height over α, resampled evenly from 0 to π/2

struct SphereKinds {
  std::vector<MaterialId> material;
  std::vector<float> radius, inverse_mass;              // m, 1/kg
  std::vector<float> ixx, iyy, izz, ixy, ixz, iyz;      // inverse inertia over mass, body axes, 1/m²
  std::vector<float> jxx, jyy, jzz, jxy, jxz, jyz;      // inertia over mass, m²
  std::vector<float> softest;                           // its greatest eigenvalue, 1/m²
  std::vector<float> height;                            // kHeightSamples + 1 a kind, m, one more to read beyond the end
  std::vector<float> blend_time;                        // s, of the approach to a rest pose
  std::vector<std::int32_t> first_pose;                 // of the kind's rest poses in the next ones
  bool any_slender = false;                             // kinds whose free rotation takes more than the loops' midpoint rule
  std::vector<float> pose_height, pose_x, pose_y, pose_z;  // m; normal in body axes; at least one pose a kind

  /// Whether the midpoint rule would feed energy into its spin.
  static bool is_slender(const BodyKind& kind) { return kind.inverse_moments[2] > 20.0 * kind.inverse_moments[0]; }
  /// Takes in those that are new; m/s².
  void take(const Kinds& kinds, double gravity) {
    while (radius.size() < kinds.size()) add(kinds[radius.size()], gravity);
  }
  std::size_t size() const { return radius.size(); }

 private:
  void add(const BodyKind& kind, double gravity);
};

}  // namespace lodestone
