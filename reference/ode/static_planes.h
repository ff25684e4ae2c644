// What a caller's own ODE world holds that the statistical level should know of.
#pragma once

#include <vector>

#include "reference/geometry.h"

struct dxWorld;
struct dxSpace;

namespace lodestone {

struct StaticPlane {
  Vec3 normal = Vec3::UnitZ();  ///< unit length
  double offset = 0.0;          ///< m, normal·x = offset
  friend bool operator==(const StaticPlane&, const StaticPlane&) = default;
};

/// The enabled planes of `space` and the spaces in it, in ODE's order; those that an OdeWorld put there are left out.
std::vector<StaticPlane> find_static_planes(dxSpace* space);

/// m/s²
Vec3 gravity_of(dxWorld* world);

}  // namespace lodestone
