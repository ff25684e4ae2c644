// Collisions and rests that were measured, by whatever means (section 5.3), as rows of a CSV file: the source
// of a signature's tables that is not ODE. The columns, of which a collision leaves none empty and a rest all
// but the normal:
//
//   kind (collision or rest), v⁻ x y z, ω⁻ x y z, n x y z, v⁺ x y z, ω⁺ x y z
//
// A collision's vectors are in any one frame; a rest's normal, of the plane upward, is in body axes.
#pragma once

#include <filesystem>
#include <vector>

#include "reference/geometry.h"

namespace lodestone {

struct MeasuredCollision {
  Vec3 velocity_before = Vec3::Zero(), angular_velocity_before = Vec3::Zero();  ///< m/s, rad/s
  Vec3 normal = Vec3::UnitZ();                                                  ///< of the plane, unit
  Vec3 velocity_after = Vec3::Zero(), angular_velocity_after = Vec3::Zero();
};

struct MeasuredTrials {
  std::vector<MeasuredCollision> collisions;
  std::vector<Vec3> rest_normals;
};

/// Throws InputError, with file and line, for anything but the columns above, finite numbers and normals of
/// unit length within 1e-3 (they are normalised).
MeasuredTrials load_trials(const std::filesystem::path& file);

/// Numbers are written so that they read back the same. Throws InputError where the file cannot be written.
void save_trials(const MeasuredTrials& trials, const std::filesystem::path& file);

}  // namespace lodestone
