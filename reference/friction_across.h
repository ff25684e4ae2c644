// Coulomb's friction across the way of what slides, where friction is bounded along that way and across it by
// turns.
#pragma once

#include "reference/geometry.h"

namespace lodestone {

/// Of the bound of friction, what is left across the way of a contact. `slip`, `whole`: m/s, along the
/// ground, of its point and of its body's centre; `in_step`: m/s, what friction at its bound gives in a step.
/// What slides with a velocity v has a velocity across it turned back by its share in v, and in a step that
/// is `in_step`: with all of the bound, what a push drives is led by its way as by rails, and turns aside
/// with it. 1 for what hardly slides, and for what turns as much as it goes.
inline double friction_share_across(const Vec3& slip, const Vec3& whole, double in_step) {
  constexpr double kTurning = 0.25;  // of the way of the whole
  const double speed = slip.norm();
  const bool slides = speed > in_step && (slip - whole).norm() < kTurning * whole.norm();
  return slides ? in_step / speed : 1.0;
}

}  // namespace lodestone
