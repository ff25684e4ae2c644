// One frictional collision in closed form: Newton restitution along the normal, friction within a pyramid
// aligned with the slip whose bound is μ times the frictionless normal impulse. This is the law that ODE's
// dWorldStep solves with dContactApprox1 and the friction direction along the slip (R. Smith, ODE manual,
// "Contact"; box-constrained LCP of Baraff, 1994), for one contact: a 3 × 3 problem whose active sets are
// enumerated instead of pivoted.
#pragma once

#include "reference/geometry.h"
#include "reference/material.h"

namespace lodestone {

/// Change of the contact point's velocity per unit impulse there: K = Σ (1/m) 1 − [r] I⁻¹ [r], symmetric
/// positive definite (1/kg).
Mat3 contact_response_matrix(double inverse_mass, const Mat3& inverse_inertia_world, const Vec3& arm);

/// Orthonormal contact frame: columns normal, slip direction, normal × slip. Where there is no slip, any
/// tangent (a fixed function of the normal).
Mat3 contact_frame(const Vec3& normal, const Vec3& velocity);

/// Impulse (N s, or per mass; world frame; on the body the normal points into) that turns the contact
/// velocity `velocity` (of the body relative to what it hits; approaching means velocity·normal < 0) into
/// normal velocity −restitution × velocity·normal. `response` as from contact_response_matrix, world frame.
/// Zero for a separating contact.
Vec3 respond_contact(const Mat3& response, const Vec3& normal, const Vec3& velocity, const ContactLaw& law);

}  // namespace lodestone
