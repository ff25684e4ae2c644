#include "lod/rungs/substep_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

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

Pace pace_for(double way) {
  return Pace(std::ceil(std::clamp(way / kStride, double(kLeastSubsteps), double(kMostSubsteps))));
}

}  // namespace

void SubstepPlan::find_ways(const ContactScene& scene, const NearPairs& pairs, double dt) {
  constexpr std::int64_t kBlock = 256;  // pairs of a job
  ways_.resize(pairs.size());
  run_in_pieces(jobs_, std::int64_t(pairs.size()), kBlock, [&](std::int64_t begin, std::int64_t end) {
    for (auto i = std::size_t(begin); i < std::size_t(end); ++i) {
      const FoundPair& pair = pairs[i];
      const double gap = pairs.gap_left(scene, pair), approach = pairs.find_approach(scene, pair, dt);
      const Vec3 first = scene.velocity(pair.first), second = scene.velocity(pair.second);
      ways_[i] = kApart;
      if (gap <= 2.0 * approach)  // twice, since others may strike them meanwhile
        ways_[i] = (first - second).norm() * dt / least_radius(scene, pair);
      else if (gap <= approach + (first.norm() + second.norm()) * dt)
        ways_[i] = kFollowing;
    }
  });
}

// What strikes another or the ground may stop within the step: then who follows close behind meets it, though
// neither gains on the other now. The way of such a pair is that of its faster body.
void SubstepPlan::mark_followers(const ContactScene& scene, const NearPairs& pairs, double dt,
                                 NearMarks& near) {
  const auto stops = [&](Participant p) {
    return !p.is_statistical() || near[p.index()] || may_strike_ground(scene, scene.body(p), dt);
  };
  for (bool any = true; any;) {
    any = false;
    std::erase_if(following_, [&](std::size_t i) {
      const FoundPair& pair = pairs[i];
      if (!stops(pair.first) && !stops(pair.second)) return false;
      mark(pair, near);
      const double speed = std::max(scene.velocity(pair.first).norm(), scene.velocity(pair.second).norm());
      ways_[i] = speed * dt / least_radius(scene, pair);
      return any = true;
    });
  }
}

// Through every pair of two that are near anybody: who is struck may be faster than its way says. What sleeps
// or is full hangs together with others through contacts that no pair tells of here: all of it is one, in the
// place after the last body.
void SubstepPlan::find_islands(const ContactScene& scene, const NearPairs& pairs, const NearMarks& near) {
  const auto others = std::int32_t(scene.bodies.size());
  islands_.make_room(scene.bodies.size() + 1);
  longest_of_island_.resize(scene.bodies.size() + 1);
  const auto begin = [&](std::int32_t body) {
    islands_.set_apart(body);
    longest_of_island_[std::size_t(body)] = kApart;
  };
  for (const std::int32_t body : near.marked()) begin(body);
  begin(others);
  const auto node_of = [&](Participant p) {
    return p.is_full() || scene.asleep(p) ? others : std::int32_t(p.index());
  };
  const auto takes_part = [&](Participant p) { return node_of(p) == others || near[p.index()]; };
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto [first, second] = std::pair(pairs[i].first, pairs[i].second);
    if (takes_part(first) && takes_part(second)) islands_.join(node_of(first), node_of(second));
  }
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (ways_[i] < 0.0) continue;
    double& longest = longest_of_island_[std::size_t(islands_.root_of(node_of(pairs[i].first)))];
    longest = std::max(longest, ways_[i]);
  }
}

// Of the islands that touch them.
void SubstepPlan::find_ways_to_solids(const ContactScene& scene, std::span<const SolidContact> solid_contacts,
                                      double dt) {
  for (const SolidContact& contact : solid_contacts) {
    const StatisticalBody& body = scene.bodies[std::size_t(contact.slot)];
    if (body.motion == Motion::asleep) continue;
    const Vec3 velocity = body.velocity - contact.part->velocity_at(body.position);
    double& longest = longest_of_island_[std::size_t(islands_.root_of(contact.slot))];
    longest = std::max(longest, velocity.norm() * dt / scene.kind_of(body).shape->radius);
  }
}

void SubstepPlan::make(const ContactScene& scene, const NearPairs& pairs,
                       std::span<const SolidContact> solid_contacts, double dt, NearMarks& near) {
  find_ways(scene, pairs, dt);
  following_.clear();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (ways_[i] >= 0.0) mark(pairs[i], near);
    if (ways_[i] == kFollowing) following_.push_back(i);
  }
  mark_followers(scene, pairs, dt, near);
  for (const SolidContact& contact : solid_contacts)
    near.mark(Participant::statistical(std::size_t(contact.slot)));

  find_islands(scene, pairs, near);
  find_ways_to_solids(scene, solid_contacts, dt);
  std::array<bool, kMostSubsteps + 1> any = {};
  const auto pace_of = [&](std::int32_t node) {
    const Pace pace = pace_for(longest_of_island_[std::size_t(islands_.root_of(node))]);
    any[pace] = true;
    return pace;
  };
  const auto others = std::int32_t(scene.bodies.size());
  for (const std::int32_t body : near.marked()) {
    const Participant p = Participant::statistical(std::size_t(body));
    near.set_pace(p, pace_of(scene.asleep(p) ? others : body));
  }
  if (longest_of_island_[std::size_t(islands_.root_of(others))] != kApart)
    near.set_full_pace(pace_of(others));
  paces_.clear();
  for (std::size_t pace = 1; pace < any.size(); ++pace)
    if (any[pace]) paces_.push_back(Pace(pace));
}

}  // namespace lodestone
