// What a body is like besides its shape, mass and material, on any rung.
#pragma once

#include <limits>

namespace lodestone {

/// What it meets and what acts on it. Numbers out of their ranges throw InputError.
struct BodyProperties {
  /// Bits, as ODE has them: two bodies meet if either's category shares a bit with what the other collides
  /// with.
  unsigned category = ~0u, collide = ~0u;
  bool gravity = true;                                 ///< whether gravity acts on it
  double linear_damping = 0.0, angular_damping = 0.0;  ///< 1/s, ≥ 0: a velocity falls as exp(−damping · t)
  double max_angular_speed = std::numeric_limits<double>::infinity();  ///< rad/s, > 0
  bool kinematic = false;   ///< whether it moves as its velocity says, through whatever it meets
  bool allow_sleep = true;  ///< whether it may fall asleep by itself
  friend bool operator==(const BodyProperties&, const BodyProperties&) = default;
};

/// Whether bodies or geoms with these bits meet, by the rule of ODE's dSpaceCollide.
inline bool may_meet(unsigned category_a, unsigned collide_a, unsigned category_b, unsigned collide_b) {
  return (category_a & collide_b) != 0 || (category_b & collide_a) != 0;
}

}  // namespace lodestone
