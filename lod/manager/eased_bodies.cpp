#include "lod/manager/eased_bodies.h"

#include <algorithm>

#include "lod/manager/levels.h"
#include "lod/statistical/parting.h"

namespace lodestone {
namespace {

constexpr double kInEarnest = 6.0;  // × the speed of parting
constexpr double kSinks = 0.5;      // × that speed: what is as fast has not come down yet …
constexpr double kPatience = 8.0;   // … and is held back so many times as long

}  // namespace

void EasedBodies::add(std::uint32_t body, OdeBodyId ode) { bodies_.push_back({body, ode, kEasedTime}); }

// At the speed of parting the drag is the body's weight.
void EasedBodies::hold_back(Levels& levels, double dt) {
  const double gravity = levels.statistical_settings.gravity.norm();
  std::erase_if(bodies_, [&](Eased& eased) {
    const auto& [body, ode, left_s] = eased;
    if (!(levels.bodies[body].ode == ode)) return true;
    OdeWorld& world = *levels.full.world();
    if (world.asleep(ode)) return false;
    const Shape& shape = *levels.bodies.shape(body);
    const double slow = parting_speed(shape.radius, gravity);
    const RigidState state = world.state(ode);
    const double speed = std::max(state.velocity.norm(), state.angular_velocity.norm() * shape.radius);
    if (speed > kInEarnest * slow) return true;
    const double rate = std::min(gravity / slow, 1.0 / dt), mass = levels.bodies[body].mass;  // 1/s
    const Quat& q = state.orientation;
    world.add_force(ode, -rate * mass * state.velocity,
                    -rate * mass * (q * (shape.inertia_per_mass * (q.conjugate() * state.angular_velocity))));
    eased.left_s -= speed > kSinks * slow ? dt / kPatience : dt;
    return eased.left_s <= 0.0;
  });
}

}  // namespace lodestone
