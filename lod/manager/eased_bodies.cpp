#include "lod/manager/eased_bodies.h"

#include <algorithm>

#include "lod/manager/levels.h"
#include "lod/statistical/parting.h"

namespace lodestone {
namespace {

constexpr double kInEarnest = 3.0;  // × the speed of parting: nothing held back becomes so fast by itself
constexpr double kSinks = 0.5;      // × that speed: what is as fast has not come down yet …
constexpr double kPatience = 8.0;   // … and is held back so many times as long

}  // namespace

void EasedBodies::add(std::uint32_t body, OdeBodyId ode, const Vec3& position, double radius,
                      double deepest) {
  bodies_.push_back({body, ode, position, radius, deepest, kEasedTime});
}

void EasedBodies::wake_in(Levels& levels, const Eigen::AlignedBox3d& box) const {
  for (const Eased& eased : bodies_) {
    const double reach = (1.0 + kTouchMargin) * eased.radius + eased.deepest;
    if (box.squaredExteriorDistance(eased.begin) <= reach * reach &&
        levels.bodies[eased.body].ode == eased.ode)
      levels.wake(eased.body);
  }
}

// At the speed of parting the drag is the body's weight.
void EasedBodies::hold_back(Levels& levels, double dt) {
  const double gravity = levels.statistical_settings.gravity.norm();
  std::erase_if(bodies_, [&](Eased& eased) {
    if (!(levels.bodies[eased.body].ode == eased.ode)) return true;
    OdeWorld& world = *levels.full.world();
    if (world.asleep(eased.ode)) return false;
    const double slow = parting_speed(eased.radius, gravity);
    const RigidState state = world.state(eased.ode);
    const double speed = std::max(state.velocity.norm(), state.angular_velocity.norm() * eased.radius);
    if (speed > kInEarnest * slow || (state.position - eased.begin).norm() > eased.deepest) return true;
    const double rate = std::min(gravity / slow, 1.0 / dt), mass = levels.bodies[eased.body].mass;  // 1/s, kg
    const Shape& shape = *levels.bodies.shape(eased.body);
    const Quat& q = state.orientation;
    world.add_force(eased.ode, -rate * mass * state.velocity,
                    -rate * mass * (q * (shape.inertia_per_mass * (q.conjugate() * state.angular_velocity))));
    eased.left_s -= speed > kSinks * slow ? dt / kPatience : dt;
    return eased.left_s <= 0.0;
  });
}

}  // namespace lodestone
