// What a body is like beside its shape, mass and material, on whatever rung it is.
#pragma once

#include <limits>

namespace lodestone {

struct BodyProperties {
  /// Bits, as ODE's: two meet where either's category is among what the other collides with.
  unsigned category = ~0u, collide = ~0u;
  bool gravity = true;
  double linear_damping = 0.0, angular_damping = 0.0;  ///< 1/s, ≥ 0: a velocity falls as exp(−damping · t)
  double max_angular_speed = std::numeric_limits<double>::infinity();  ///< rad/s, > 0
  bool kinematic = false;  ///< goes where its velocity takes it, whatever it meets
  bool allow_sleep = true;
  friend bool operator==(const BodyProperties&, const BodyProperties&) = default;
};

/// Whether bodies or geoms of these bits meet: dSpaceCollide's rule.
inline bool may_meet(unsigned category_a, unsigned collide_a, unsigned category_b, unsigned collide_b) {
  return (category_a & collide_b) != 0 || (category_b & collide_a) != 0;
}

}  // namespace lodestone
