// Sweeps that are led on along the way of the ones before, as conjugate gradients are (Silcowitz, Niebe and
// Erleben, A nonsmooth nonlinear conjugate gradient method for interactive contact force problems, 2010): by
// themselves sweeps carry a weight or a blow from body to body, one in each.
//
// Included by the solvers alone, which are compiled for lanes.
#pragma once

#include "lod/contact/contact_lanes.h"

namespace lodestone::lane {

/// Goes on by a part, of each lane, of the way on which a point's impulses are, and adds what the last sweep
/// changed of them to that way. `Led` has both, N s over the units of mass, as `change[3]` and `way[3]`.
template <Lanes L, class Led>
struct Leading {
  Led* led;  // beside the points
  const L& part;

  LODESTONE_INLINE bool operator()(const PointAtHand<L>& at, Vec3Lanes<L>& impulse) const {
    Led& own = led[at.index];
    L further[3];
    for (int axis = 0; axis < 3; ++axis) {
      further[axis] = part * own.way[axis];
      at.point.impulse[axis] = at.point.impulse[axis] + further[axis];
      own.way[axis] = further[axis] + own.change[axis];
    }
    impulse = at.along_axes(further);
    return true;
  }
};

}  // namespace lodestone::lane
