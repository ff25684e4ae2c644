// What masses and inertias every rung can take. Beyond them ODE's solver loses the body in rounding and ends
// in an assertion.
#pragma once

#include "reference/shape.h"

namespace lodestone {

inline constexpr double kLeastMass = 1e-6, kGreatestMass = 1e12;  // kg
/// The least principal moment of inertia over the mass, over the square of the greatest distance of a vertex
/// from its axis. A solid's own is a twelfth or more.
inline constexpr double kLeastMoment = 1e-5;

/// Each throws InputError.
void check_mass(double mass);  ///< kg
void check_inertia(const Shape& shape);

}  // namespace lodestone
