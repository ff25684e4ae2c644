// How slowly what stands rocks and falls over, by its size and by gravity: laws of rest that ask for a time
// or a speed would else take the turning point of its rocking for rest.
#pragma once

#include <algorithm>
#include <cmath>

namespace lodestone {

inline constexpr double kUsualGravity = 9.81;  ///< m/s², on earth

/// √(R/g) over that of a body of .3 m on earth: 1 to 10, and 1 without gravity. `radius` R in m, `gravity` g
/// in m/s².
inline double rocking_slowness(double radius, double gravity) {
  constexpr double kRadius = 0.3, kMost = 10.0;  // m
  if (!(gravity > 0.0)) return 1.0;
  return std::clamp(std::sqrt(radius / kRadius * (kUsualGravity / gravity)), 1.0, kMost);
}

/// √g over that on earth: .1 to 1, and 1 without gravity.
inline double falling_speed_share(double gravity) {
  return gravity > 0.0 ? std::clamp(std::sqrt(gravity / kUsualGravity), 0.1, 1.0) : 1.0;
}

}  // namespace lodestone
