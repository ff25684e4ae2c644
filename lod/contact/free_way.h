// How far a body that was struck goes before ground that its contacts knew nothing of.
#pragma once

#include <functional>

#include "lod/ground/met_ground.h"
#include "lod/statistical/statistical_body.h"

namespace lodestone {

/// m: how far a body reaches from its centre along `direction` (unit, world).
using ReachFunction = std::function<double(const Vec3& direction)>;

/// The part of `way` (m), 0 to 1, that a body of `radius` m goes from `center` before it touches a solid of
/// the ground that it does not touch at the beginning: conservative advancement (Mirtich, Impulse-based
/// dynamic simulation of rigid body systems, 1996). The ground is taken as it stands at the step's beginning.
double find_free_way(const MetGround& ground, const Vec3& center, const Vec3& way, double radius,
                     const ReachFunction& reach_of);

/// The same of a statistical body, as its sphere or its hull.
double find_free_way(const MetGround& ground, const StatisticalBody& body, const Shape& shape,
                     const Vec3& from, const Vec3& way);

}  // namespace lodestone
