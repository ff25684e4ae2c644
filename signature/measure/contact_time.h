// When a freely flying body first touches a plane. By conservative advancement (Mirtich, Impulse-based
// dynamic simulation, 1996): no step is longer than what the gap allows. Mirtich bounds the speed of every
// point by ‖v‖ + R‖ω‖; here points keep their own velocities and only their accelerations are bounded, so
// that steps are as long as the square root of the gap allows, and the last ones converge quadratically.
#pragma once

#include "reference/shape.h"

namespace lodestone {

/// Flight without gravity over the plane z = 0, from touch to touch.
class ContactTime {
 public:
  /// `shape` must outlive it.
  explicit ContactTime(const Shape& shape) : shape_(shape) {}

  /// Moves `state` along its flight to where its lowest point, approaching, is within 1e-6 R of the plane.
  /// False, with `state` somewhere on the flight, where the body never touches again. The orientation is
  /// accurate to some 1e-6 rad.
  bool advance(RigidState& state);

  /// The point that touches (or is lowest), from the centre of mass, world axes (m); its gap (m) and its
  /// vertical velocity (m/s).
  struct Lowest {
    Vec3 arm = Vec3::Zero();
    double gap = 0.0, velocity = 0.0;
  };
  Lowest find_lowest(const RigidState& state);

 private:
  const Shape& shape_;
  int vertex_ = 0;  // last found lowest: where the next climb starts
};

}  // namespace lodestone
