#include "reference/ode/timed_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lodestone {
namespace {

constexpr double kFastImpact = 3.0;   // × g·h: what comes slower lands as ODE has it; of bodies at rest the
                                      // answers to such would never end
constexpr double kFreeImpact = 15.0;  // × g·h: what comes slower may rock on its other vertices, which fall
                                      // by less than g
constexpr double kTogether = 0.04;    // of a step: vertices that strike within it of the first strike with it

class TimedContacts {
 public:
  TimedContacts(std::span<const NearPoint> near, const TimedStep& step)
      : near_(near),
        step_(step),
        gravity_(-step.normal.dot(step.acceleration)),
        fall_(gravity_ * step.duration) {
    for (const NearPoint& point : near_)
      if (strikes(point)) first_ = std::min(first_, time_of(point));
  }

  std::optional<TimedImpact> append(std::vector<ContactPoint>& contacts) const {
    for (const NearPoint& point : near_) {
      if (strikes(point)) {
        if (time_of(point) <= first_ + kTogether * step_.duration) contacts.push_back(impact(point));
      } else if (point.depth > 0.0) {
        contacts.push_back({at(point.arm), step_.normal, point.depth});
      } else if (is_held(point)) {
        contacts.push_back({at(point.arm), step_.normal, 0.0, point.depth / step_.duration, -point.depth});
      }
    }
    if (first_ >= step_.duration) return std::nullopt;
    return TimedImpact{first_, step_.duration * step_.acceleration};
  }

 private:
  double approach(const NearPoint& point) const {
    return -step_.normal.dot(step_.body.velocity + step_.body.angular_velocity.cross(point.arm));
  }

  /// From the start of the step; what is long inside counts as having come in during the last one. ODE's
  /// velocities are those of the middle of the last step: it moves a body by the velocity that a step ends
  /// with.
  double time_of(const NearPoint& point) const {
    const double now = approach(point) + 0.5 * fall_, gap = -point.depth;
    const double then = now * now + 2.0 * gravity_ * gap;  // its square
    return then > 0.0 ? std::max(-step_.duration, 2.0 * gap / (now + std::sqrt(then))) : -step_.duration;
  }

  bool strikes(const NearPoint& point) const {
    return approach(point) > std::max(step_.bounce_velocity, kFastImpact * fall_) &&
           time_of(point) < step_.duration;
  }

  bool is_held(const NearPoint& point) const {
    const double approach_now = approach(point);
    return approach_now <= 0.0 && -point.depth < step_.duration * (approach_now + fall_);
  }

  /// ODE gives it e times its approach at the start of the step, at the step's end. Gravity speeds it up
  /// until it strikes and pulls it back afterwards, from the middle of the last step to that of this one. A
  /// bounce that would be over before the end is none. What may not have fallen freely is given nothing by
  /// gravity: at restitution .9 it would never come to rest.
  ContactPoint impact(const NearPoint& point) const {
    const double rebound = step_.restitution * approach(point), half = 0.5 * step_.duration;
    const double fell = gravity_ * (step_.restitution * (half + first_) - (half - first_));
    const double lift = approach(point) > kFreeImpact * fall_ ? fell : std::min(fell, 0.0);
    const Vec3 spin = step_.turns ? step_.body.angular_velocity : Vec3(Vec3::Zero());
    return {at(rotation_from_vector(first_ * spin) * point.arm), step_.normal, 0.0,
            std::max(-rebound, lift) / (1.0 + step_.restitution), std::max(0.0, -point.depth)};
  }

  Vec3 at(const Vec3& arm) const { return step_.body.position + arm; }

  std::span<const NearPoint> near_;
  const TimedStep& step_;
  double gravity_;  // m/s² into the plane
  double fall_;     // what gravity adds to a velocity in the step
  double first_ = std::numeric_limits<double>::infinity();
};

}  // namespace

std::optional<TimedImpact> append_timed_contacts(std::span<const NearPoint> near, const TimedStep& step,
                                                 std::vector<ContactPoint>& contacts) {
  return TimedContacts(near, step).append(contacts);
}

Quat turned_on(const RigidState& start, double time) {
  return (rotation_from_vector(time * start.angular_velocity) * start.orientation).normalized();
}

RigidState end_of_step(const RigidState& start, const RigidState& end, const TimedImpact& impact) {
  RigidState moved = end;
  moved.position -= impact.time * (end.velocity - start.velocity - impact.fall);
  moved.orientation = turned_on(end, -impact.time);
  return moved;
}

}  // namespace lodestone
