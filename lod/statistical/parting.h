// How bodies come apart that overlap: since one of them changed its rung, slowly enough that nobody sees it.
#pragma once

#include <algorithm>
#include <cmath>

namespace lodestone {

inline constexpr double kBroughtOverlap = 0.02;  // over R: what a pile at rest has anyway is less
/// Over R: into each other so far only bodies get that were added so; then none of the two sleeps.
inline constexpr double kWakingOverlap = 0.1;
/// s awake after a change of rung, in which overlaps that it brought are undone so slowly.
inline constexpr float kEasedTime = 2.0f;
/// s for which a body that is put where it overlaps others goes on to part: where there is no room, no
/// longer.
inline constexpr float kPlacedTime = 5.0f;

/// m/s, of a body of `radius` m under `gravity` m/s²: 2 mm in 1/60 s for one of .13 m.
inline double parting_speed(double radius, double gravity) {
  return 0.1 * std::sqrt(std::max(gravity, 1.0) * radius);
}

}  // namespace lodestone
