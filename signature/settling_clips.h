// Settling clips: recorded ends of ODE drops, which hold what no single response captures: how a body rocks
// and rolls to rest. Dimensionless as the rest of the signature, so they serve every size.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "signature/signature.h"

namespace lodestone {

inline constexpr float kClipHeightRange = 4.0f;  ///< over R
inline constexpr float kClipSpeedRange = 4.0f;   ///< over √(gR), and times √(R/g)

/// State in a clip: position over R relative to the clip's start (z over the plane), orientation up to the
/// yaw that the player adds, velocities over √(gR) and √(g/R).
struct ClipState {
  Vec3 position = Vec3::Zero();
  Quat orientation = Quat::Identity();
  Vec3 velocity = Vec3::Zero();
  Vec3 angular_velocity = Vec3::Zero();
};

ClipFrame encode_frame(const ClipState& state, float extent);
ClipState decode_frame(const ClipFrame& frame, float extent);

/// State in `clip` at `frame` (fractional, clamped to the clip). Between frames poses are interpolated;
/// velocities stay those of the frame before, for they change at impacts, which must stay sudden.
ClipState find_clip_state(const Signature& signature, const SettlingClip& clip, double frame);

/// How a body moves at a contact, dimensionless and in body axes, so that yaw does not matter.
struct SettlingKey {
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();  ///< of the plane
  Eigen::Vector3f velocity = Eigen::Vector3f::Zero(), angular_velocity = Eigen::Vector3f::Zero();
  float energy = 0.0f;  ///< kinetic and potential over m g R, height zero at the plane
};

/// The entries of a signature's clips, arranged for look-up by the plane's normal in body axes.
class ClipIndex {
 public:
  ClipIndex() = default;
  /// `inertia_per_mass`: of the shape, over R².
  ClipIndex(const Signature& signature, const Mat3& inertia_per_mass);

  /// The entry nearest to `key` by 4|Δn|² + |Δv|² + |Δω|², of an energy at most `key`'s plus `energy_slack`;
  /// none beyond `distance_limit`.
  std::optional<ClipEntry> find_nearest(const SettlingKey& key, float energy_slack,
                                        float distance_limit) const;
  bool empty() const { return entries_.empty(); }

 private:
  struct Nearest {
    float distance;
    std::int64_t entry = -1;
  };
  static constexpr int kSide = 12;  // cells along an edge of the cube that holds the sphere of normals
  static constexpr float kRounding = 1e-5f;  // of a normal's coordinates, and more
  static constexpr std::size_t kEight = 8;
  static int cell_along(float coordinate);
  static std::size_t cell_of(const std::array<int, 3>& place);
  void search(std::size_t begin, std::size_t end, const SettlingKey& key, float greatest_energy,
              Nearest& nearest) const;
  std::vector<std::uint32_t> start_;  // of each cell's run of `entries_`
  std::vector<ClipEntry> entries_;    // by cell, in a cell of least energy first
  // Of each entry's key: normal, velocity and angular velocity, energy; and of seven more that are none, so
  // that eight can be looked at from each on.
  static constexpr std::size_t kCoordinates = 9;
  std::array<std::vector<float>, kCoordinates> coordinates_;
  std::vector<float> energy_;
};

}  // namespace lodestone
