// A collision's vectors and its numbers: the working plane of response.h, with e1 = n = z, e2 = x, e3 = y
// where a frame is chosen.
#pragma once

#include "signature/measure/measured_trials.h"
#include "signature/response.h"

namespace lodestone {

/// θ, φ, ψ (0 … 2π), ‖V⁻‖ and R‖Ω⁻‖ of a collision of a body of this radius (m).
CollisionConfiguration configuration_of(const MeasuredCollision& collision, double radius);

/// (V_rigid − V_particle)/s and RΩ⁺/s in the collision's working frame.
Response response_of(const MeasuredCollision& collision, double radius, double restitution);

/// The collision with these numbers and this response, in the frame e1 = z, e2 = x, e3 = y.
MeasuredCollision collision_with(const CollisionConfiguration& configuration, const Response& response,
                                 double radius, double restitution);

}  // namespace lodestone
