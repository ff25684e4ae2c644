// n: the plane's normal; a point r of the body is at height z + r·n and moves vertically with v_z + r·(n ×
// ω), all in body axes.
#include "signature/measure/contact_time.h"

#include <cmath>

#include "reference/free_rotation.h"

namespace lodestone {
namespace {

constexpr double kTouch = 1e-6;     // over R: a gap this small is contact
constexpr double kClosing = 1e-9;   // of the speed unit: a slower approach is a rest
constexpr double kMaxTurn = 0.15;   // rad a step
constexpr double kMinTurn = 1e-4;   // rad a step: a point that just left the plane gets away from it
constexpr double kWholeTurn = 6.3;  // rad, in which a rising body would have touched again
constexpr int kMaxSteps = 5000;
// Acceleration of a point of a free body over ω²R. Centripetal 1; ω̇ at most ω²/√3 (Euler's equations with
// |I₁ − I₂| ≤ I₃); and ω grows by 1.09 at most over kMaxTurn.
constexpr double kAcceleration = 1.9;

/// Height and vertical velocity of a point now.
struct Point {
  double height = 0.0, velocity = 0.0;
};

// When a point could touch at the earliest, accelerated downwards all the while.
double earliest_touch(const Point& p, double acceleration) {
  const double height = std::max(0.0, p.height);
  const double root = std::sqrt(p.velocity * p.velocity + 2.0 * acceleration * height);
  if (p.velocity < 0.0) return 2.0 * height / (root - p.velocity);
  return acceleration > 0.0 ? (p.velocity + root) / acceleration : 1e300;
}

// The orientation `time` seconds later, to fourth order: a free body's spin is constant, its angular velocity
// a function of the orientation (Celledoni, Marthinsen, Owren, Commutator-free Lie group methods, 2003). The
// midpoint rule would leave gaps of 1e-4 R at these steps.
Quat advance_precisely(const Quat& orientation, const Vec3& now, const Vec3& spin, const Shape& shape,
                       double time) {
  const auto turn = [&](const Vec3& by, const Quat& q) { return rotation_from_vector(time * by) * q; };
  const Vec3& k1 = now;
  const Quat half = turn(0.5 * k1, orientation);
  const Vec3 k2 = angular_velocity(half, spin, shape);
  const Vec3 k3 = angular_velocity(turn(0.5 * k2, orientation), spin, shape);
  const Vec3 k4 = angular_velocity(turn(k3 - 0.5 * k1, half), spin, shape);
  const Vec3 middle = 2.0 * (k2 + k3);
  return turn((middle - k1 + 3.0 * k4) / 12.0, turn((middle - k4 + 3.0 * k1) / 12.0, orientation))
      .normalized();
}

bool advance_sphere(double radius, RigidState& state) {
  if (state.velocity.z() >= 0.0) return false;
  state.position += std::max(0.0, (state.position.z() - radius) / -state.velocity.z()) * state.velocity;
  return true;
}

}  // namespace

bool ContactTime::advance(RigidState& state) {
  if (shape_.sphere_radius) return advance_sphere(*shape_.sphere_radius, state);
  const Hull& hull = shape_.hull;
  const double radius = shape_.radius;
  const Vec3 spin = spin_of(state.orientation, state.angular_velocity, shape_);
  const double closing = kClosing * (state.velocity.norm() + radius * state.angular_velocity.norm());
  double turned = 0.0;
  for (int i = 0; i < kMaxSteps; ++i) {
    const Mat3 rotation = state.orientation.toRotationMatrix();
    const Vec3 omega = shape_.inverse_inertia_per_mass * (rotation.transpose() * spin);
    const Vec3 normal = rotation.row(2), turning = normal.cross(omega);
    const auto point = [&](int vertex) {
      const Vec3& r = hull.vertices[vertex];
      return Point{state.position.z() + r.dot(normal), state.velocity.z() + r.dot(turning)};
    };
    state.angular_velocity = rotation * omega;
    vertex_ = find_support(hull, -normal, vertex_);
    const Point lowest = point(vertex_);
    if (lowest.height < kTouch * radius && lowest.velocity < -closing) return true;
    if (state.velocity.z() >= 0.0 && (state.position.z() >= radius || turned > kWholeTurn)) return false;

    // The longest time for which no point, at its velocity and the bound on its acceleration, touches: from
    // above, as the lowest point then bounds it.
    const double speed = omega.norm(), acceleration = kAcceleration * speed * speed * radius;
    double time = speed > 0.0 ? kMaxTurn / speed : 1e300;
    if (speed == 0.0) time = earliest_touch(lowest, 0.0);
    for (int bounding = -1, next = vertex_; next != bounding && speed > 0.0;) {
      bounding = next;
      next = find_support(hull, -(normal + time * turning), bounding);
      time = std::min(time, earliest_touch(point(next), acceleration));
    }
    if (!(time < 1e300)) return false;
    if (speed > 0.0 && lowest.height < kTouch * radius) time = std::max(time, kMinTurn / speed);
    turned += speed * time;
    state.position += time * state.velocity;
    state.orientation = advance_precisely(state.orientation, state.angular_velocity, spin, shape_, time);
  }
  return false;
}

ContactTime::Lowest ContactTime::find_lowest(const RigidState& state) {
  Lowest lowest;
  if (shape_.sphere_radius) {
    lowest.arm = {0.0, 0.0, -*shape_.sphere_radius};
  } else {
    vertex_ = find_support(shape_.hull, state.orientation.conjugate() * Vec3(0, 0, -1), vertex_);
    lowest.arm = state.orientation * shape_.hull.vertices[vertex_];
  }
  lowest.gap = state.position.z() + lowest.arm.z();
  lowest.velocity = (state.velocity + state.angular_velocity.cross(lowest.arm)).z();
  return lowest;
}

}  // namespace lodestone
