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

ClipFrame encode_frame(const ClipPose& pose, float extent);
ClipPose decode_frame(const ClipFrame& frame, float extent);

/// Pose of `clip` at `frame` (fractional, clamped to the clip), between frames by interpolation.
ClipPose find_clip_pose(const Signature& signature, const SettlingClip& clip, double frame);

/// How a body moves at a contact, dimensionless and in body axes (as ClipEntry).
struct SettlingState {
  Eigen::Vector3f normal, velocity, angular_velocity;
  float energy = 0.0f;
};

/// The entry nearest to `state` by 4|Δn|² + |Δv|² + |Δω|², among those of no higher energy; none where every one is farther than `max_distance`.
std::optional<int> find_nearest_entry(const Signature& signature, const SettlingState& state, float max_distance);

}  // namespace lodestone
