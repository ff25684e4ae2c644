#include "lod/manager/eased_bodies.h"

#include <algorithm>

#include "lod/manager/levels.h"
#include "lod/statistical/parting.h"

namespace lodestone {
namespace {

constexpr double kInEarnest =
    3.0;  // × the speed of parting: nothing that is held back becomes so fast by itself
constexpr double kSinks = 0.5;     // × that speed: what is as fast has not come down yet …
constexpr double kPatience = 8.0;  // … and is held back so many times as long

}  // namespace

void EasedBodies::add(std::uint32_t body, OdeBodyId ode, const Vec3& position, double deepest) {
  bodies_.push_back({body, ode, position, deepest, kEasedTime});
}

void EasedBodies::wake_in(Levels& levels, const Eigen::AlignedBox3d& box) const {
  for (const Eased& eased : bodies_) {
    if (!(levels.bodies[eased.body].ode == eased.ode) || !levels.asleep(eased.body)) continue;
    const double reach = (1.0 + kTouchMargin) * levels.bodies.shape(eased.body)->radius;
    if (box.squaredExteriorDistance(levels.state(eased.body).position) <= reach * reach)
      levels.wake(eased.body);
  }
}

// At the speed of parting the drag is the body's weight; it opposes sinking alone.
void EasedBodies::hold_back(Levels& levels, double dt) {
  const Vec3& gravity = levels.statistical_settings.gravity;
  const double strength = gravity.norm();
  std::erase_if(bodies_, [&](Eased& eased) {
    if (!(levels.bodies[eased.body].ode == eased.ode)) return true;
    OdeWorld& world = *levels.full.world();
    if (world.asleep(eased.ode)) return false;
    const double slow = parting_speed(levels.bodies.shape(eased.body)->radius, strength);
    const RigidState state = world.state(eased.ode);
    const double speed = state.velocity.norm();
    if (strength == 0.0 || speed > kInEarnest * slow || (state.position - eased.begin).norm() > eased.deepest)
      return true;
    const Vec3 down = gravity / strength;
    const double rate = std::min(strength / slow, 1.0 / dt),
                 mass = levels.bodies[eased.body].mass,  // 1/s, kg
        sinking = std::max(0.0, state.velocity.dot(down));
    if (sinking > 0.0) world.add_force(eased.ode, -rate * mass * sinking * down, Vec3::Zero());
    eased.left_s -= speed > kSinks * slow ? dt / kPatience : dt;
    return eased.left_s <= 0.0;
  });
}

}  // namespace lodestone
