// Torque-free rotation in loops over spheres: the explicit midpoint rule on the rotation group, whose angular
// momentum is kept as it is the state, and then the turn that gives the kinetic energy back which the flight
// began with: that of the step before would take on another rounding error in each step. Without branches;
// lod/statistical/flight.h has the same in double precision, with the derivation.
#pragma once

#include "lod/simd/lane_math.h"

namespace lodestone::lane {

/// M a for the symmetric M of a kind, in body axes.
LODESTONE_INLINE F3 times(const Tensors& m, int kind, F3 a) {
  return {m.xx[kind] * a.x + m.xy[kind] * a.y + m.xz[kind] * a.z,
          m.xy[kind] * a.x + m.yy[kind] * a.y + m.yz[kind] * a.z,
          m.xz[kind] * a.x + m.yz[kind] * a.y + m.zz[kind] * a.z};
}

/// The turn of the body's own axes, as the tangent of half its angle times its axis, after which `own` (m²/s,
/// the angular momentum there) has the energy of a free rotation: `twice_energy` (J/kg).
LODESTONE_INLINE F3 turn_to_energy(const Tensors& inverse, int kind, F3 own, float twice_energy) {
  const F3 omega = times(inverse, kind, own);
  const float now = dot(own, omega), excess = now - twice_energy,
              inverse_square = 1.0f / most(dot(own, own), 1e-30f);
  const F3 across = omega - (now * inverse_square) * own;
  const float slope = dot(across, across), inverse_slope = 1.0f / most(slope, 1e-30f);
  const float curve = dot(across, times(inverse, kind, across)) - twice_energy * slope * inverse_square;
  // Where the great circle does not reach the energy (bend > 1) it goes as near as it can: x = −slope/curve.
  const float bend = curve * excess * inverse_slope * inverse_slope;
  constexpr float kFarthest = 1e3f;  // beyond it lies only what comes of a spin that is none, and is dropped
  const float asked = -excess * inverse_slope / (most(bend, 1.0f) + square_root(1.0f - least(bend, 1.0f))),
              x = least(most(asked, -kFarthest), kFarthest), t = x * x * slope * inverse_square;
  const float turn = x * inverse_square / (1.0f + square_root(1.0f + t));
  return choose(slope > 1e-12f * now * now * inverse_square, turn, 0.0f) * cross(own, omega);
}

/// Within it two energies of one flight agree, as shares of them: several times what rounding makes of one.
inline constexpr float kSameEnergy = 4e-6f;

/// The orientation `time` seconds later; not of unit length to the last bit. `twice_energy` (J/kg) is that of
/// the flight's start, and becomes what the body has where that is another: where no flight is under way.
LODESTONE_INLINE Turn turned_freely(const Tensors& inverse, int kind, const Turn& q, F3 spin, float time,
                                    float& twice_energy) {
  const F3 before = turned(back(q), spin), own_rate = times(inverse, kind, before);
  const float now = dot(before, own_rate);
  twice_energy = choose(absolute(now - twice_energy) < kSameEnergy * now, twice_energy, now);
  const Turn middle = product(turn_by(turned(q, own_rate), 0.5f * time), q);
  const Turn to = product(turn_by(in_world(inverse, kind, middle, spin), time), q);
  // Of a length rounded as the turn's is: the energy over its square is what the turn can change.
  const F3 after = turned(back(to), spin);
  const float asked = twice_energy * (dot(after, after) / most(dot(spin, spin), 1e-30f));
  const F3 half = turn_to_energy(inverse, kind, after, asked);
  const float scale = 1.0f / square_root(1.0f + dot(half, half));
  return product(to, {scale, -scale * half});
}

}  // namespace lodestone::lane
