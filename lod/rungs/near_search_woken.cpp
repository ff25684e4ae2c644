// Of NearSearch: who is near those that were woken within a step, or left their balls.
#include <algorithm>
#include <tuple>

#include "lod/rungs/near_search.h"

namespace lodestone {

// Who may meet one that was woken: who is awake, full, a guest or asleep, or was woken in this step, too.
void NearSearch::find_partners(const Ball& ball, const SupportLevel& support) {
  const std::span<const StatisticalBody> bodies = support.bodies();
  partners_.clear();
  const auto meets = [](const Ball& a, const Vec3& center, double reach) {
    return (center - a.center).squaredNorm() < (double(a.reach) + reach) * (double(a.reach) + reach);
  };
  const bool any_hulls = x_.size() > spheres_;  // else the cells hold spheres alone, if they are there still
  if (any_hulls)
    cells_.find_near(ball.center, double(ball.reach), [&](std::uint32_t other) {
      if (other < spheres_ || !meets(ball, {x_[other], y_[other], z_[other]}, double(reach_[other]))) return;
      const std::size_t mover = other - spheres_;
      partners_.push_back(mover < movers_.size() ? Participant::statistical(std::size_t(movers_[mover]))
                                                 : Participant::full(mover - movers_.size()));
    });
  woken_cells_.find_near(ball.center, double(ball.reach), [&](std::uint32_t other) {
    if (meets(ball, {woken_x_[other], woken_y_[other], woken_z_[other]}, double(woken_reach_[other])))
      partners_.push_back(woken_[other]);
  });
  const Ball still = at_rest(ball);
  const auto add_where_it_lies = [&](std::size_t other) {
    if (meets(still, bodies[other].position, kBall * support.kind_of(bodies[other]).shape->radius))
      partners_.push_back(Participant::statistical(other));
  };
  sleepers_.of(StatisticalModel::support).find_near(still.center, double(still.reach), add_where_it_lies);
  for (std::size_t guest = own_bodies_; guest < bodies.size(); ++guest) add_where_it_lies(guest);
}

std::span<const NearPair> NearSearch::find_woken(double elapsed, const SupportLevel& support,
                                                 std::span<const FullNeighbor> neighbors,
                                                 std::span<const Participant> woken) {
  const std::span<const StatisticalBody> bodies = support.bodies();
  const std::size_t before = pairs_.size(), first = woken_.size();
  const auto place_of = [&](Participant p) {
    const Vec3& at = p.is_full() ? neighbors[p.index()].state.position : bodies[p.index()].position;
    return std::tuple(at.x(), at.y(), at.z(), p);
  };
  woken_.insert(woken_.end(), woken.begin(), woken.end());
  const auto newly_woken = std::span(woken_).subspan(first);
  std::ranges::sort(newly_woken, {}, place_of);
  for (const Participant p : newly_woken) {
    const Ball ball = [&] {
      if (p.is_full()) return ball_of(neighbors[p.index()], elapsed);
      const StatisticalBody& body = bodies[p.index()];
      return ball_of(body.position, body.velocity, support.kind_of(body).shape->radius, elapsed);
    }();
    woken_x_.push_back(ball.center.x()), woken_y_.push_back(ball.center.y());
    woken_z_.push_back(ball.center.z()), woken_reach_.push_back(ball.reach);
  }
  woken_cells_.fill({woken_x_, woken_y_, woken_z_, woken_reach_});

  new_.assign(newly_woken.begin(), newly_woken.end());
  std::ranges::sort(new_);
  const auto is_new = [&](Participant p) { return std::ranges::binary_search(new_, p); };
  const auto in_order = [](Participant a, Participant b) { return NearPair(std::min(a, b), std::max(a, b)); };
  known_.clear();
  for (const auto& [a, b] : pairs_)
    if (is_new(a) || is_new(b)) known_.push_back(in_order(a, b));
  std::ranges::sort(known_);
  const auto is_guest = [&](Participant p) {
    return p.is_statistical() && support.is_guest(std::int32_t(p.index()));
  };
  const auto nobodys_matter = [&](Participant a, Participant b) {
    return a == b || (a.is_full() && b.is_full()) || (is_guest(a) && is_guest(b));
  };
  for (std::size_t i = first; i < woken_.size(); ++i) {
    const Participant self = woken_[i];
    find_partners({Vec3(woken_x_[i], woken_y_[i], woken_z_[i]), woken_reach_[i]}, support);
    std::ranges::sort(partners_, {}, place_of);
    partners_.erase(std::unique(partners_.begin(), partners_.end()), partners_.end());
    for (const Participant other : partners_) {
      const bool added_before = is_new(other) && place_of(other) < place_of(self);
      if (!added_before && !nobodys_matter(self, other) &&
          !std::ranges::binary_search(known_, in_order(self, other)))
        pairs_.emplace_back(self, other);
    }
  }
  filter_pairs(before, [&](Participant p) {
    return p.is_full() ? neighbors[p.index()].owner : bodies[p.index()].owner;
  });
  return std::span(pairs_).subspan(before);
}

}  // namespace lodestone
