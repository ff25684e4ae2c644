#include "lod/rungs/substep_plan.h"

#include <algorithm>
#include <cmath>

namespace lodestone {
namespace {

constexpr int kLeastSubsteps = 3, kMostSubsteps = 12;
constexpr double kStride =
    0.07;  // over R: how far two bodies may close in in a substep, while kMostSubsteps lasts

bool may_strike_ground(const ContactScene& scene, const StatisticalBody& body, double dt) {
  const double fall = 0.5 * scene.world.gravity_strength() * dt * dt;
  return std::ranges::any_of(scene.world.planes, [&](const HalfSpace& plane) {
    return plane.height_of(body.position) - scene.kind_of(body).shape->radius <=
           fall - std::min(0.0, body.velocity.dot(plane.normal)) * dt;
  });
}

void mark(const FoundPair& pair, NearMarks& near) { near.mark(pair.first), near.mark(pair.second); }

}  // namespace

// What strikes another or the ground may stop within the step: then who follows close behind meets it, though
// neither gains on the other now. Returns the farthest way of a follower, over R.
double SubstepPlan::mark_followers(const ContactScene& scene, double dt, NearMarks& near) {
  const auto stops = [&](Participant p) {
    return !p.is_statistical() || near[p.index()] || may_strike_ground(scene, scene.body(p), dt);
  };
  double farthest = 0.0;
  for (bool any = true; any;) {
    any = false;
    std::erase_if(following_, [&](const FoundPair* pair) {
      if (!stops(pair->first) && !stops(pair->second)) return false;
      mark(*pair, near);
      const double speed = std::max(scene.velocity(pair->first).norm(), scene.velocity(pair->second).norm());
      farthest = std::max(farthest, speed * dt / least_radius(scene, *pair));
      return any = true;
    });
  }
  return farthest;
}

int SubstepPlan::make(const ContactScene& scene, const NearPairs& pairs,
                      std::span<const SolidContact> solid_contacts, double dt, NearMarks& near) {
  bool any = false;
  double longest = 0.0;  // way over R
  following_.clear();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const FoundPair& pair = pairs[i];
    const double gap = pairs.gap_left(scene, pair), approach = pairs.find_approach(scene, pair, dt);
    const Vec3 first = scene.velocity(pair.first), second = scene.velocity(pair.second);
    if (gap <= 2.0 * approach) {  // twice, since others may strike them meanwhile
      any = true;
      mark(pair, near);
      longest = std::max(longest, (first - second).norm() * dt / least_radius(scene, pair));
    } else if (gap <= approach + (first.norm() + second.norm()) * dt) {
      following_.push_back(&pair);
    }
  }
  const double farthest = mark_followers(scene, dt, near);
  any |= farthest > 0.0;
  longest = std::max(longest, farthest);
  for (const SolidContact& contact : solid_contacts)
    near.mark(Participant::statistical(std::size_t(contact.slot)));
  if (!any) return solid_contacts.empty() ? 0 : 1;
  return int(std::ceil(std::clamp(longest / kStride, double(kLeastSubsteps), double(kMostSubsteps))));
}

}  // namespace lodestone
