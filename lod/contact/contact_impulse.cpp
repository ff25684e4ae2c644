#include "lod/contact/contact_impulse.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lodestone {
namespace {

Mat3 cross_matrix(const Vec3& v) {
  Mat3 m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

// Is the tangential velocity one that friction held at `sign` of its bound leaves? At the upper bound it may
// only be negative, at the lower positive.
bool bound_is_consistent(int sign, double velocity, double tolerance) { return sign * velocity <= tolerance; }

}  // namespace

Mat3 contact_response_matrix(double inverse_mass, const Mat3& inverse_inertia_world, const Vec3& arm) {
  const Mat3 r = cross_matrix(arm);
  return inverse_mass * Mat3::Identity() - r * inverse_inertia_world * r;
}

Mat3 contact_frame(const Vec3& normal, const Vec3& velocity) {
  Vec3 slip = velocity - velocity.dot(normal) * normal;
  const double speed = slip.norm();
  if (speed > 1e-9 * velocity.norm()) {
    slip /= speed;
    slip = (slip - slip.dot(normal) * normal)
               .normalized();  // again: little is left of a nearly head-on velocity
  } else {
    slip = std::abs(normal.z()) < 0.7 ? Vec3::UnitZ().cross(normal).normalized()
                                      : Vec3::UnitX().cross(normal).normalized();
  }
  Mat3 frame;
  frame << normal, slip, normal.cross(slip);
  return frame;
}

Vec3 respond_contact(const Mat3& response, const Vec3& normal, const Vec3& velocity, const ContactLaw& law) {
  const double approach = velocity.dot(normal);
  if (!(approach < 0.0)) return Vec3::Zero();
  const double target = -law.restitution * approach;  // normal velocity afterwards
  const double bound =
      law.friction * (target - approach) / normal.dot(response * normal);  // μ × frictionless normal impulse
  // Most hits stick, and then the frame of the slip does not matter.
  const Vec3 stop = response.inverse() * (target * normal - velocity);
  const double along = stop.dot(normal);
  if (along >= 0.0 && (stop - along * normal).squaredNorm() < bound * bound) return stop;

  const Mat3 frame = contact_frame(normal, velocity);
  const Mat3 k = frame.transpose() * response * frame;
  const Vec3 u = frame.transpose() * velocity;
  const double tolerance = 1e-12 * u.norm();

  // Each tangential impulse is free (0) or at a bound (±1). The likely sets come first: sticking, then
  // sliding against the slip.
  static constexpr std::array<std::array<int, 2>, 9> kSets{
      {{0, 0}, {-1, 0}, {0, 1}, {0, -1}, {-1, 1}, {-1, -1}, {1, 0}, {1, 1}, {1, -1}}};
  Vec3 best = Vec3::Zero();
  double best_violation = 1e300;
  for (const auto& [first, second] : kSets) {
    Vec3 j(0, first * bound, second * bound);
    // Rows of the free impulses, with the held ones moved to the right-hand side.
    const double b0 = target - u[0] - k(0, 1) * j[1] - k(0, 2) * j[2];
    const double b1 = -u[1] - k(1, 1) * j[1] - k(1, 2) * j[2];
    const double b2 = -u[2] - k(2, 1) * j[1] - k(2, 2) * j[2];
    if (first == 0 && second == 0) {
      j = k.inverse() * Vec3(b0, b1, b2);
    } else if (first == 0 || second == 0) {
      const int t = first == 0 ? 1 : 2;
      const double b = t == 1 ? b1 : b2;
      const double determinant = k(0, 0) * k(t, t) - k(0, t) * k(0, t);
      j[0] = (b0 * k(t, t) - b * k(0, t)) / determinant;
      j[t] = (b * k(0, 0) - b0 * k(0, t)) / determinant;
    } else {
      j[0] = b0 / k(0, 0);
    }
    if (j[0] < 0.0) {  // friction alone lifts the contact: no normal impulse, friction at what it is
      j[0] = 0.0;
    }
    const Vec3 after = u + k * j;
    double violation = std::max({0.0, std::abs(j[1]) - bound, std::abs(j[2]) - bound}) * k(0, 0);
    if (first != 0 && !bound_is_consistent(first, after[1], tolerance))
      violation = std::max(violation, std::abs(after[1]));
    if (second != 0 && !bound_is_consistent(second, after[2], tolerance))
      violation = std::max(violation, std::abs(after[2]));
    if (violation < best_violation) {
      best_violation = violation;
      best = j;
    }
    if (violation <= tolerance) break;
  }
  return frame * best;
}

}  // namespace lodestone
