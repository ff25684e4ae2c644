// Drops to rest under ODE: rest poses (3.2.3) and settling clips.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "reference/shape.h"
#include "signature/signature.h"

namespace lodestone {

/// What is kept of one drop.
struct SettlingRecord {
  std::vector<RigidState> states;  ///< from the first low-energy contact to rest, 1/30 s apart
  bool rests = false;
  Vec3 normal = Vec3::UnitZ();     ///< at rest, in body axes
  double height = 0.0;             ///< at rest, m
};

/// Drops `shape` on z = 0 under gravity 9.81 m/s² and follows it to rest (at most 30 s at R = .2 m). Orientation and velocities are drawn from (seed, trial),
/// over heights up to 3 R and speeds up to what a fall from there gives.
SettlingRecord simulate_settling(const std::shared_ptr<const Shape>& shape, const ContactLaw& law, std::uint64_t seed, std::uint32_t trial);

/// Clusters the resting normals (within 12°), most frequent first, those of at least `frequency_min`.
std::vector<RestPose> find_rest_poses(std::span<const SettlingRecord> records, double radius, double frequency_min);

/// Makes clips of the first `count` records that rest, with their entries.
void add_clips(std::span<const SettlingRecord> records, const Shape& shape, int count, Signature& signature);

}  // namespace lodestone
