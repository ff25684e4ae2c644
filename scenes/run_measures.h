// What is observed of one body of a running scene: energy, penetration and whether its numbers are still
// finite.
#pragma once

#include "reference/shape.h"

namespace lodestone {

/// ½ m v² + ½ ωᵀ I ω, J, with the shape's true inertia.
double kinetic_energy(const Shape& shape, double mass, const RigidState& state);

/// How far the deepest vertex lies below the plane normal·x = offset (normal of unit length), m; negative
/// above it.
double depth_below(const Shape& shape, const RigidState& state, const Vec3& normal, double offset);

/// How far the deepest vertex, or a sphere, is in a box (`sides`, m, about `box`), from where it would come
/// out first, m; not positive outside.
double depth_in_box(const Shape& shape, const RigidState& state, const Vec3& sides, const RigidState& box);

bool is_finite(const RigidState& state);

}  // namespace lodestone
