// A caller's space of each type that ODE has.
#pragma once

#include <ode/ode.h>

namespace lodestone::testing {

enum class SpaceType { simple, hash, sweep, quadtree };

inline dSpaceID make_space(SpaceType type, dSpaceID in = nullptr) {
  const dVector3 center = {0, 0, 0}, half = {50, 50, 50};
  switch (type) {
    case SpaceType::simple:
      return dSimpleSpaceCreate(in);
    case SpaceType::hash:
      return dHashSpaceCreate(in);
    case SpaceType::sweep:
      return dSweepAndPruneSpaceCreate(in, dSAP_AXES_XYZ);
    default:
      return dQuadTreeSpaceCreate(in, center, half, 4);
  }
}

}  // namespace lodestone::testing
