#include "lod/rungs/substep_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace lodestone {
namespace {

constexpr int kLeastSubsteps = 3, kMostSubsteps = 12;
constexpr double kLongest = 1.0 / 60.0;     // s, of a step taken at once
constexpr double kLongestOfSmall = 0.0615;  // over √(R/g), of a substep, but for slow heaps: three times that
constexpr int kManyBodies = 30;             // awake, of an island that may take it: of fewer, each one shows
constexpr double kUneven = 20.0;            // ratio of the masses of two that may touch
// Over R: how far two bodies may close in in a substep, while kMostSubsteps lasts.
constexpr double kStride = 0.07;

// Over R: who moves less than that against its ground in a step does not strike it.
constexpr double kRides = 0.01;

bool may_strike(const ContactScene& scene, const StatisticalBody& body, std::span<const HalfSpace> planes,
                double dt) {
  const double fall = 0.5 * scene.world.gravity_strength() * dt * dt;
  return std::ranges::any_of(planes, [&](const HalfSpace& plane) {
    return plane.height_of(body.position) - scene.kind_of(body).shape->radius <=
           fall - std::min(0.0, body.velocity.dot(plane.normal)) * dt;
  });
}

Pace pace_for(double way, double least) {
  return Pace(std::ceil(std::min(std::max(way / kStride, least), double(kMostSubsteps))));
}

bool is_uneven(const ContactScene& scene, const FoundPair& pair) {
  const double first = scene.mass(pair.first), second = scene.mass(pair.second);
  return std::max(first, second) >= kUneven * std::min(first, second);
}

}  // namespace

void SubstepPlan::find_ways(const ContactScene& scene, const NearPairs& pairs, double dt) {
  constexpr std::int64_t kBlock = 256;  // pairs of a job
  const auto is_other = [&](Participant p) { return p.is_full() || scene.asleep(p); };
  const auto is_kinematic = [&](Participant p) { return scene.properties(p).kinematic; };
  const auto stands = [&](Participant p) { return scene.asleep(p) || is_kinematic(p); };
  ways_.resize(pairs.size());
  run_in_pieces(jobs_, std::int64_t(pairs.size()), kBlock, [&](std::int64_t begin, std::int64_t end) {
    for (auto i = std::size_t(begin); i < std::size_t(end); ++i) {
      const FoundPair& pair = pairs[i];
      const double gap = pairs.gap_left(scene, pair), approach = pairs.find_approach(scene, pair, dt);
      const Vec3 first = scene.velocity(pair.first), second = scene.velocity(pair.second);
      PairWay& way = ways_[i] = {pair.first, pair.second, is_other(pair.first), is_other(pair.second)};
      way.is_hard = pair.first.is_full() || pair.second.is_full() || is_kinematic(pair.first) ||
                    is_kinematic(pair.second) ||
                    (!stands(pair.first) && !stands(pair.second) && is_uneven(scene, pair));
      if (gap <= 2.0 * approach)  // twice, since others may strike them meanwhile
        way.along = (first - second).norm() * dt / least_radius(scene, pair);
      else if (gap <= approach + (first.norm() + second.norm()) * dt)
        way.along = kFollowing;
    }
  });
}

// What strikes another or the ground may stop within the step: then who follows close behind meets it, though
// neither gains on the other now. The way of such a pair is that of its faster body.
void SubstepPlan::mark_followers(const ContactScene& scene, const NearPairs& pairs, const FacesBelow& faces,
                                 double dt, NearMarks& near) {
  std::ranges::sort(striking_);
  const auto stops = [&](Participant p) {
    if (!p.is_statistical() || near[p.index()]) return true;
    const auto slot = std::int32_t(p.index());
    return may_strike(scene, scene.body(p), scene.world.planes, dt) ||
           may_strike(scene, scene.body(p), faces.of(slot), dt) ||
           std::ranges::binary_search(striking_, slot);
  };
  stopped_.clear();
  const auto meet = [&](std::size_t i) {
    const FoundPair& pair = pairs[i];
    ways_[i].along = std::max(scene.velocity(pair.first).norm(), scene.velocity(pair.second).norm()) * dt /
                     least_radius(scene, pair);
    for (const Participant p : {pair.first, pair.second})
      if (p.is_statistical() && !near[p.index()]) near.mark(p), stopped_.push_back(p.index());
  };
  for (const std::size_t i : following_)
    if (stops(pairs[i].first) || stops(pairs[i].second)) meet(i);
  if (stopped_.empty()) return;
  following_of_.clear();
  for (const std::size_t i : following_)
    for (const Participant p : {pairs[i].first, pairs[i].second})
      if (p.is_statistical()) following_of_.emplace_back(p.index(), i);
  std::ranges::sort(following_of_);
  while (!stopped_.empty()) {
    const std::size_t body = stopped_.back();
    stopped_.pop_back();
    for (auto own = std::ranges::lower_bound(following_of_, std::pair(body, std::size_t(0)));
         own != following_of_.end() && own->first == body; ++own)
      if (ways_[own->second].along == kFollowing) meet(own->second);
  }
}

// Through every pair of two that are near anybody: who is struck may be faster than its way says. What sleeps
// or is full hangs together with others through contacts that no pair tells of here: all of it is one, in the
// place after the last body.
void SubstepPlan::find_islands(const ContactScene& scene, double dt, const NearMarks& near) {
  const auto others = std::int32_t(scene.bodies.size());
  islands_.make_room(scene.bodies.size() + 1);
  island_of_root_.resize(scene.bodies.size() + 1);
  const auto begin = [&](std::int32_t body) {
    islands_.set_apart(body);
    island_of_root_[std::size_t(body)] = {};
  };
  for (const std::int32_t body : near.marked()) begin(body);
  begin(others);
  const auto first_of = [&](const PairWay& w) {
    return w.first_is_other ? others : std::int32_t(w.first.index());
  };
  const auto second_of = [&](const PairWay& w) {
    return w.second_is_other ? others : std::int32_t(w.second.index());
  };
  const auto take_part = [&](const PairWay& w) {
    return (w.first_is_other || near[w.first.index()]) && (w.second_is_other || near[w.second.index()]);
  };
  for (const PairWay& w : ways_)
    if (take_part(w)) islands_.join(first_of(w), second_of(w));
  for (const PairWay& w : ways_) {
    if (!take_part(w)) continue;
    Island& island = island_of(first_of(w));
    island.longest = std::max(island.longest, w.along);
    island.is_hard |= w.is_hard;
  }
  for (const std::int32_t i : near.marked()) {
    const StatisticalBody& body = scene.bodies[std::size_t(i)];
    if (body.motion == Motion::asleep) continue;
    Island& island = island_of(i);
    ++island.bodies;
    const double fall = scene.world.gravity_strength() * dt * dt / scene.kind_of(body).shape->radius;
    island.fall = std::max(island.fall, fall);
  }
}

// Of the islands that touch them.
void SubstepPlan::find_ways_to_solids(const ContactScene& scene, std::span<const SolidContact> solid_contacts,
                                      double dt, const NearMarks& near) {
  for (const SolidContact& contact : solid_contacts) {
    const StatisticalBody& body = scene.bodies[std::size_t(contact.slot)];
    if (body.motion == Motion::asleep || !near[std::size_t(contact.slot)]) continue;
    const Vec3 velocity = body.velocity - contact.part->velocity_at(body.position);
    Island& island = island_of(contact.slot);
    island.longest = std::max(island.longest, velocity.norm() * dt / scene.kind_of(body).shape->radius);
    island.is_hard |= contact.part->moves();
  }
}

void SubstepPlan::make(const ContactScene& scene, const NearPairs& pairs,
                       std::span<const SolidContact> solid_contacts, const FacesBelow& faces, double dt,
                       NearMarks& near) {
  find_ways(scene, pairs, dt);
  following_.clear(), striking_.clear();
  for (std::size_t i = 0; i < ways_.size(); ++i) {
    if (ways_[i].along >= 0.0) mark(ways_[i], near);
    if (ways_[i].along == kFollowing) following_.push_back(i);
  }
  for (auto left = solid_contacts; !left.empty();) {
    const auto of_body = first_run_of(left);
    left = left.subspan(of_body.size());
    const auto slot = std::size_t(of_body.front().slot);
    const StatisticalBody& body = scene.bodies[slot];
    const std::optional<Vec3> along = find_velocity_of_ground(of_body, dt);
    const bool moves_along =
        along && (along->isZero(0.0) || !may_strike(scene, body, scene.world.planes, dt));
    if (body.is_sphere() || !moves_along)
      near.mark(Participant::statistical(slot));
    else if ((body.velocity - *along).norm() * dt > kRides * scene.kind_of(body).shape->radius)
      striking_.push_back(std::int32_t(slot));
  }
  mark_followers(scene, pairs, faces, dt, near);

  find_islands(scene, dt, near);
  find_ways_to_solids(scene, solid_contacts, dt, near);
  std::array<bool, kMostSubsteps + 1> any = {};
  const double least = std::max(1.0, dt / kLongest - 1e-6);
  const auto pace_of = [&](std::int32_t node) {
    const Island& island = island_of(node);
    const bool is_slow_heap = island.bodies >= kManyBodies && !island.is_hard;
    const double for_fall = std::sqrt(island.fall) / kLongestOfSmall;
    const Pace pace =
        pace_for(island.longest, is_slow_heap ? std::max(least, for_fall / kLeastSubsteps)
                                              : std::max({least, double(kLeastSubsteps), for_fall}));
    any[pace] = true;
    return pace;
  };
  const auto others = std::int32_t(scene.bodies.size());
  for (const std::int32_t body : near.marked()) {
    const Participant p = Participant::statistical(std::size_t(body));
    near.set_pace(p, pace_of(scene.asleep(p) ? others : body));
  }
  if (island_of(others).longest != kApart) near.set_full_pace(pace_of(others));
  paces_.clear();
  for (std::size_t pace = 1; pace < any.size(); ++pace)
    if (any[pace]) paces_.push_back(Pace(pace));
}

}  // namespace lodestone
