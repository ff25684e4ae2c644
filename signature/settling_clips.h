// Settling clips: recorded ends of ODE drops, which hold what no single response captures: how a body rocks and rolls to rest.
// Dimensionless as the rest of the signature, so they serve every size.
#pragma once

#include <optional>
#include <span>

#include "signature/signature.h"

namespace lodestone {

inline constexpr float kClipHeightRange = 4.0f;  ///< over R

/// Pose in a clip: position over R relative to the clip's start (z over the plane), orientation up to the yaw that the player adds.
struct ClipPose {
  Vec3 position = Vec3::Zero();
  Quat orientation = Quat::Identity();
};

/// The same with velocities, over √(gR) and √(g/R).
struct ClipState {
  Vec3 position = Vec3::Zero();
  Quat orientation = Quat::Identity();
  Vec3 velocity = Vec3::Zero();
  Vec3 angular_velocity = Vec3::Zero();
};

ClipFrame encode_frame(const ClipPose& pose, float extent);
ClipPose decode_frame(const ClipFrame& frame, float extent);

/// State in `clip` at `frame` (fractional, clamped to the clip): poses between frames by interpolation, velocities those of the motion from the frame
/// before to the frame after.
ClipState find_clip_state(const Signature& signature, const SettlingClip& clip, double frame);

/// How a body moves at a contact, dimensionless and in body axes, so that yaw does not matter.
struct SettlingKey {
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();  ///< of the plane
  Eigen::Vector3f velocity = Eigen::Vector3f::Zero(), angular_velocity = Eigen::Vector3f::Zero();
  float energy = 0.0f;                                ///< kinetic and potential over m g R, height zero at the plane
};

/// The entries of a signature's clips, arranged for look-up by the plane's normal in body axes.
class ClipIndex {
 public:
  ClipIndex() = default;
  /// `inertia_per_mass`: of the shape, over R²; `max_distance`: of what find_nearest may return.
  ClipIndex(const Signature& signature, const Mat3& inertia_per_mass, float max_distance);

  /// The entry nearest to `key` by 4|Δn|² + |Δv|² + |Δω|², of an energy at most `key`'s plus `energy_slack`; none beyond the greatest distance.
  std::optional<ClipEntry> find_nearest(const SettlingKey& key, float energy_slack) const;
  bool empty() const { return keys_.empty(); }

 private:
  static constexpr int kSide = 6;  // cells along an edge of the cube of normals
  float max_distance_ = 0.0f;
  std::vector<SettlingKey> keys_;
  std::vector<ClipEntry> entries_;
  std::vector<std::uint32_t> start_;  // of each cell's run of `near_`
  std::vector<std::uint32_t> near_;   // keys within reach of the cell
};

}  // namespace lodestone
