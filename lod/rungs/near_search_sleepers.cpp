// Of NearSearch: the near pairs of those that move with those that sleep, or were just woken.
#include <algorithm>

#include "lod/rungs/near_search.h"

namespace lodestone {

// By what is known of the sleepers near a mover since a step before. False: they must be looked up.
bool NearSearch::add_known_sleeper_pairs(std::size_t ball, const SupportLevel& support) {
  const std::span<const StatisticalBody> bodies = support.bodies();
  const std::int32_t mover = movers_[ball - spheres_];
  const Ball own = ball_at_rest(ball);
  const Vec3& center = own.center;
  const auto reach = double(own.reach);
  const auto known = known_sleepers_.near(sleepers_, mover, center, reach);
  if (!known) return false;
  sleepers_near_.clear();
  for (const std::int32_t slot : *known) {
    if (slot >= support.size() || !support.asleep(slot)) continue;  // it woke
    const double limit = reach + kBall * support.kind_of(bodies[std::size_t(slot)]).shape->radius;
    if ((bodies[std::size_t(slot)].position - center).squaredNorm() < limit * limit)
      sleepers_near_.push_back(slot);
  }
  add_sleeper_pairs(Participant::statistical(std::size_t(mover)), bodies);
  return true;
}

// Of a body with the sleepers of `support` in sleepers_near_.
void NearSearch::add_sleeper_pairs(Participant self, std::span<const StatisticalBody> bodies) {
  sort_by_place(bodies, sleepers_near_);
  for (const std::int32_t slot : sleepers_near_)
    pairs_.emplace_back(self, Participant::statistical(std::size_t(slot)));
}

// Of hulls that move, statistical and full, and all that sleeps.
void NearSearch::find_sleeper_pairs(const SupportLevel& support, std::span<const FullNeighbor> neighbors,
                                    const TablesLevel& tables) {
  if (sleepers_.empty()) return;
  const std::span<const StatisticalBody> bodies = support.bodies();
  known_sleepers_.make_place(std::size_t(support.size()));
  for (std::size_t i = spheres_; i < x_.size(); ++i) {
    const bool full = i >= spheres_ + movers_.size();
    if (full && neighbors[i - spheres_ - movers_.size()].asleep) continue;
    if (!full && add_known_sleeper_pairs(i, support)) continue;
    const Ball own = ball_at_rest(i);
    const Vec3& center = own.center;
    const auto own_reach = double(own.reach);
    const auto note = [&](std::int32_t slot) { sleepers_near_.push_back(slot); };
    const Participant self = full ? Participant::full(i - spheres_ - movers_.size())
                                  : Participant::statistical(std::size_t(movers_[i - spheres_]));
    sleepers_near_.clear();
    each_sleeping_hull(center, own_reach, support, note);
    add_sleeper_pairs(self, bodies);
    sleepers_near_.clear();
    each_sleeping_sphere(center, own_reach, tables, note);
    std::ranges::sort(sleepers_near_);
    for (const std::int32_t slot : sleepers_near_) pairs_.emplace_back(self, guest(slot));
    if (full) continue;
    const double way =
        2.0 * (center - bodies[self.index()].position).norm();  // the ball is half a step ahead
    known_sleepers_.look(sleepers_, std::int32_t(self.index()), center, own_reach, way,
                         [&](const Vec3& at, double reach, const auto& add) {
                           bool spheres = false;
                           each_sleeping_hull(at, reach, support, add);
                           each_sleeping_sphere(at, reach, tables, [&](std::int32_t) { spheres = true; });
                           return !spheres;
                         });
  }
}

// Of hulls with spheres that other spheres have just woken: these are in no cell of this step, and no longer
// among the sleepers.
void NearSearch::find_pairs_of_woken_spheres(const TablesLevel& tables) {
  const Spheres& s = tables.spheres();
  sleepers_near_.clear();
  for (std::size_t i = spheres_; i < std::size_t(s.awake); ++i) sleepers_near_.push_back(s.slot[i]);
  std::ranges::sort(sleepers_near_);
  for (const std::int32_t slot : sleepers_near_)
    for (std::size_t ball = spheres_; ball < x_.size(); ++ball) {
      const Ball hull_ball = ball_at_rest(ball);
      const double limit = double(hull_ball.reach) + kBall * tables.radius(slot);
      if ((tables.position(slot) - hull_ball.center).squaredNorm() >= limit * limit) continue;
      const Participant hull = participant(std::uint32_t(ball), tables);
      pairs_.emplace_back(guest(slot), hull);
    }
}

// Of spheres that move, with those that others have just woken, and sleeping hulls.
void NearSearch::find_sleeping_hulls_near_spheres(const SupportLevel& support, const TablesLevel& tables) {
  if (sleepers_.of(StatisticalModel::support).empty()) return;
  const Spheres& s = tables.spheres();
  for (std::int64_t i = 0; i < s.awake; ++i) {
    sleepers_near_.clear();
    each_sleeping_hull(s.position(i), hull_reach(tables, i, tables.still_reach(i)), support,
                       [&](std::int32_t slot) { sleepers_near_.push_back(slot); });
    sort_by_place(support.bodies(), sleepers_near_);
    for (const std::int32_t slot : sleepers_near_)
      pairs_.emplace_back(guest(s.slot[std::size_t(i)]), Participant::statistical(std::size_t(slot)));
  }
}

}  // namespace lodestone
