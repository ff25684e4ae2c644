// Torque-free rotation in loops over spheres: the explicit midpoint rule on the rotation group, whose angular
// momentum is kept as it is the state, and then the turn that gives the kinetic energy back which that had
// before. Without branches; lod/statistical/flight.h has the same in double precision, with the derivation.
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
  // Where the great circle does not reach the energy (bend > 1) it goes as near as it can.
  const float bend = least(curve * excess * inverse_slope * inverse_slope, 1.0f);
  const float x = -excess * inverse_slope / (1.0f + square_root(1.0f - bend)),
              t = x * x * slope * inverse_square;
  const float turn = x * inverse_square / (1.0f + square_root(1.0f + t));
  return choose(slope > 1e-12f * now * now * inverse_square, turn, 0.0f) * cross(own, omega);
}

/// The orientation `time` seconds later; not of unit length to the last bit.
LODESTONE_INLINE Turn turned_freely(const Tensors& inverse, int kind, const Turn& q, F3 spin, float time) {
  const F3 before = turned(back(q), spin), omega = turned(q, times(inverse, kind, before));
  const Turn middle = product(turn_by(omega, 0.5f * time), q);
  const Turn to = product(turn_by(in_world(inverse, kind, middle, spin), time), q);
  const F3 half =
      turn_to_energy(inverse, kind, turned(back(to), spin), dot(before, times(inverse, kind, before)));
  const float scale = 1.0f / square_root(1.0f + dot(half, half));
  return product(to, {scale, -scale * half});
}

}  // namespace lodestone::lane
