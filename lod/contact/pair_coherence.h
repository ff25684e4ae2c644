// What is kept of a pair of bodies from an earlier search, and for how long it still holds (temporal
// coherence): contacts that the bodies take along, and gaps that they cannot have closed since.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "lod/contact/pair_body.h"
#include "reference/state_archive.h"

namespace lodestone {

inline constexpr double kTakenAlong = 0.02;  // over the lesser R: so far bodies take a contact along

/// A contact that its bodies take along, until they have moved so far that it must be looked for anew. Kept
/// for every pair that touches: floats, which are fine enough for arms.
struct HeldContact {
  Vec3 normal = Vec3::UnitZ();
  std::int32_t count = 0;
  std::array<Eigen::Vector3f, 4> on_first, on_second;  ///< m, its points on each body's surface, body axes

  void archive(StateArchive& a) {
    a(normal, count);
    for (std::size_t i = 0; i < std::min(std::size_t(count), on_first.size()); ++i)
      a(on_first[i], on_second[i]);
  }
};
HeldContact hold(const PairContact& contact, const PairBody& first, const PairBody& second);
/// Where its points are now, and their gaps along the normal that it was found with.
PairContact follow(const HeldContact& held, const PairBody& first, const PairBody& second);

/// How two bodies lie to each other. Kept for every pair that is near, so not aligned to vector registers.
struct PairPose {
  using Turn = Eigen::Matrix<float, 4, 1, Eigen::DontAlign>;
  Eigen::Vector3f apart = Eigen::Vector3f::Zero();  ///< m, of the first from the second
  Turn first{0, 0, 0, 1}, second{0, 0, 0, 1};       ///< orientations
};
PairPose pose_of(const PairBody& first, const PairBody& second);
/// m: no gap between them has changed by more since they lay so.
double find_motion_since(const PairPose& then, const PairBody& first, const PairBody& second);
/// m: what is left now, at least, of a gap of the two hulls that was found when they lay so.
struct GapLeft {
  double anyhow = 0.0;  ///< of their distance
  double along = 0.0;   ///< along its axis
};
GapLeft find_gap_left(const HullGap& found, const PairPose& then, const PairBody& first,
                      const PairBody& second);

/// m: the gap of the two hulls now along the axis on which it was found, which it is then.
double look_along(HullGap& found, const PairBody& first, const PairBody& second);

/// The gap of two pieces of bodies as it was found.
struct KnownGap {
  HullGap axis = {.normal = Vec3::Zero()};  ///< where the next search begins; zero: anywhere
  std::optional<PairPose> when;             ///< how they lay then; none: never looked for

  void archive(StateArchive& a) { a(axis, when); }
};

}  // namespace lodestone
