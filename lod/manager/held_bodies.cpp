#include "lod/manager/held_bodies.h"

#include <algorithm>
#include <cmath>

#include "lod/statistical/rest_law.h"
#include "reference/ode/body_joints.h"
#include "reference/ode/callers_bodies.h"
#include "reference/rocking.h"

namespace lodestone {

void HeldBodies::note_woken(const Neighborhood& neighborhood) {
  if (still_.empty()) return;
  for (const FullNeighbor& body : neighborhood.bodies) {
    const auto known = std::ranges::lower_bound(still_, body.owner, {}, &Still::owner);
    if (known != still_.end() && known->owner == body.owner && known->asleep && !body.asleep)
      known->still_s = 0.0;
  }
}

void HeldBodies::find_sets(const Levels& levels, const Neighborhood& neighborhood) {
  const std::size_t count = neighborhood.bodies.size();
  const auto is_kinematic = [&](std::int32_t neighbor) {
    return callers::is_kinematic(neighborhood.ode_bodies[std::size_t(neighbor)]);
  };
  joined_.set_all_apart(count);
  for (const FullContact& contact : neighborhood.contacts)
    if (contact.second >= 0 && !is_kinematic(contact.first) && !is_kinematic(contact.second))
      joined_.join(contact.first, contact.second);
  sets_.assign(count, {});
  for (std::size_t i = 0; i < count; ++i) {
    set_of(i).pressed |= !neighborhood.bodies[i].push.is_zero();
    set_of(i).moved |= neighborhood.bodies[i].carried;
  }
  std::vector<std::uint32_t> near;
  for (const std::uint32_t waiting : levels.put_off.waiting()) {
    near.clear();
    levels.find_near(waiting, 1.0, Level::full, near, false);
    for (const std::uint32_t owner : near)
      if (const std::int32_t i = levels.full.index_of(levels.bodies[owner].ode); i >= 0)
        set_of(std::size_t(i)).moved = true;
  }
}

const std::vector<bool>& HeldBodies::find_still(const Levels& levels, const Neighborhood& neighborhood,
                                                double dt) {
  constexpr double kMean = 0.1;  // s, over which means go
  const StatisticalSettings& settings = levels.statistical_settings;
  const double gravity = settings.gravity.norm(), part = 1.0 - std::exp(-dt / kMean),
               still_speed = RestLaw(settings.sleep).full_sleep_speed(gravity);  // m/s
  find_sets(levels, neighborhood);
  std::swap(still_, before_);
  still_.clear();
  const std::size_t members = levels.full.members().size();
  for (std::size_t i = 0; i < members; ++i) {
    const FullNeighbor& body = neighborhood.bodies[i];
    Set& set = set_of(i);
    if (!set.pressed || has_joints(neighborhood.ode_bodies[i])) continue;
    const auto before = std::ranges::lower_bound(before_, body.owner, {}, &Still::owner);
    Still now = before != before_.end() && before->owner == body.owner ? *before : Still{body.owner};
    now.velocity += part * (body.state.velocity - now.velocity);
    now.turning += part * (body.state.angular_velocity - now.turning);
    const bool still = !set.moved && !body.moved && now.velocity.norm() < still_speed &&
                       now.turning.norm() * body.shape->radius < still_speed;
    now.still_s = still ? now.still_s + dt : 0.0;
    const double still_time =
        5.0 * settings.sleep.time * rocking_slowness(body.shape->radius, gravity);  // s, as alone
    set.has_awake |= now.still_s < still_time || !levels.bodies.properties(body.owner).allow_sleep;
    still_.push_back(now);
  }
  std::ranges::sort(still_, {}, &Still::owner);
  falls_asleep_.assign(members, false);
  if (!settings.sleeping) return falls_asleep_;
  for (std::size_t i = 0; i < members; ++i) {
    const FullNeighbor& body = neighborhood.bodies[i];
    const auto known = std::ranges::lower_bound(still_, body.owner, {}, &Still::owner);
    if (known == still_.end() || known->owner != body.owner) continue;
    falls_asleep_[i] = !set_of(i).has_awake && !body.asleep;
    known->asleep = falls_asleep_[i] || body.asleep;
  }
  return falls_asleep_;
}

}  // namespace lodestone
