// Rest poses (3.2.3) out of settling trials.
#pragma once

#include <numbers>
#include <span>
#include <vector>

#include "reference/shape.h"
#include "signature/signature.h"

namespace lodestone {

struct SettlingRecord;

/// rad: resting normals this near are one pose.
inline constexpr double kSamePose = 12.0 * std::numbers::pi / 180.0;

/// Clusters the resting normals, most frequent first, and keeps those of at least `frequency_min` of all
/// records. Their basins come from the hull of `shape` (0 for a sphere).
std::vector<RestPose> find_rest_poses(std::span<const SettlingRecord> records, const Shape& shape,
                                      double frequency_min);

}  // namespace lodestone
