#include "lod/rungs/near_search.h"

#include <algorithm>
#include <array>

namespace lodestone {
namespace {

constexpr int kMostLone = 4096;  // spheres: more of them are hardly ever all apart, and rooms take memory

}  // namespace

void NearSearch::sort_by_place(std::span<const StatisticalBody> bodies,
                               std::vector<std::int32_t>& indices) const {
  const auto place = [&](std::int32_t index) {
    const Vec3& p = bodies[std::size_t(index)].position;
    return std::array{p.x(), p.y(), p.z()};
  };
  std::ranges::sort(indices, {}, place);
}

// Those awake, first those that were so in the last step, in their order then: the rest of the sorting is
// little.
void NearSearch::take_movers(const SupportLevel& support) {
  const std::span<const std::int32_t> awake = support.awake();
  kept_.assign(awake.size(), 0);
  std::erase_if(movers_, [&](std::int32_t index) {
    if (index >= support.size() || !support.is_among_awake(index)) return true;
    kept_[std::size_t(support.place_among_awake(index))] = 1;
    return false;
  });
  if (movers_.size() == awake.size()) return;
  for (std::size_t i = 0; i < awake.size(); ++i)
    if (!kept_[i]) movers_.push_back(awake[i]);
}

// By insertion, while that takes few moves.
void NearSearch::sort_nearly_sorted(std::vector<Placed>& placed) {
  constexpr std::size_t kFewMoves = 16;  // of each, on average
  std::size_t left = kFewMoves * placed.size();
  for (std::size_t i = 1; i < placed.size(); ++i) {
    if (!(placed[i] < placed[i - 1])) continue;
    const Placed one = placed[i];
    std::size_t at = i;
    for (; at > 0 && one < placed[at - 1]; --at) placed[at] = placed[at - 1];
    placed[at] = one;
    if (i - at > left) return std::sort(placed.begin(), placed.end());
    left -= i - at;
  }
}

// By place, so that nothing hangs on the order in which bodies were added.
void NearSearch::sort_movers(std::span<const StatisticalBody> bodies) {
  placed_.clear();
  for (const std::int32_t index : movers_) {
    const Vec3& p = bodies[std::size_t(index)].position;
    placed_.push_back({p.x(), p.y(), p.z(), index});
  }
  sort_nearly_sorted(placed_);
  for (std::size_t i = 0; i < placed_.size(); ++i) movers_[i] = placed_[i].index;
}

NearSearch::Ball NearSearch::ball_of(const Vec3& position, const Vec3& velocity, double radius,
                                     double elapsed) const {
  const Vec3 half_way = (0.5 * dt_) * (velocity - drift_);
  return {position - elapsed * drift_ + half_way,
          float(kBall * radius + half_way.norm() + 0.5 * gravity_.norm() * dt_ * dt_), half_way};
}

// A force acts on it within the step: to statistical bodies it is given before.
NearSearch::Ball NearSearch::ball_of(const FullNeighbor& body, double elapsed) const {
  return ball_of(body.state.position, body.state.velocity + (dt_ / body.mass) * body.force,
                 body.shape->radius, elapsed);
}

// As seen by what lies still: all of its way through the step.
NearSearch::Ball NearSearch::at_rest(const Ball& ball) const {
  return {ball.center + (0.5 * dt_) * drift_, ball.reach + float(0.5 * dt_ * drift_.norm())};
}

void NearSearch::add_ball(const Ball& ball) {
  x_.push_back(ball.center.x()), y_.push_back(ball.center.y()), z_.push_back(ball.center.z());
  reach_.push_back(ball.reach);
}

void NearSearch::add_hull_balls(std::span<const StatisticalBody> bodies, const SupportLevel& support,
                                std::span<const FullNeighbor> neighbors) {
  half_way_.clear();
  for (const std::int32_t index : movers_) {
    const StatisticalBody& body = bodies[std::size_t(index)];
    const Ball ball = ball_of(body.position, body.velocity, support.kind_of(body).shape->radius, 0.0);
    add_ball(ball);
    half_way_.push_back(ball.half_way);
  }
  for (const FullNeighbor& n : neighbors) add_ball(ball_of(n, 0.0));
}

void NearSearch::invite_cornered(const TablesLevel& tables, const SupportLevel& support) {
  if (tables.cornered().empty()) return;
  own_bodies_ = std::size_t(support.size());
  guest_of_slot_.resize(std::max(guest_of_slot_.size(), std::size_t(tables.size())), -1);
  for (const std::int32_t slot : tables.cornered()) guest(slot);
}

void NearSearch::forget_guests() {
  for (const Guest& guest : guests_)
    if (std::size_t(guest.slot) < guest_of_slot_.size()) guest_of_slot_[std::size_t(guest.slot)] = -1;
  guests_.clear();
}

void NearSearch::clear() {
  pairs_.clear();
  forget_guests();
  any_near_ = false;  // no order
}

void NearSearch::fill(double dt, const Vec3& drift, TablesLevel& tables, const SupportLevel& support,
                      std::span<const FullNeighbor> neighbors) {
  dt_ = dt, drift_ = drift;
  const Spheres& s = tables.spheres();
  spheres_ = std::size_t(s.awake);
  own_bodies_ = std::size_t(support.size());
  const bool may_have_rooms = neighbors.empty() && drift.isZero(0.0);
  if (!may_have_rooms) rooms_.give_up();
  apart_ = stay_apart(tables, support);
  take_movers(support);
  mixed_ = spheres_ > 0 && movers_.size() + neighbors.size() > 0;
  x_.clear(), y_.clear(), z_.clear(), reach_.clear();
  woken_.clear(), woken_x_.clear(), woken_y_.clear(), woken_z_.clear(), woken_reach_.clear();
  if (apart_) return;
  const bool may_be_apart = may_have_rooms && !any_near_ && pairs_.empty() && tables.size() <= kMostLone;
  if (mixed_ || spheres_ == 0) sort_movers(support.bodies());
  if (may_be_apart && rooms_.are_due() && find_rooms(tables, support)) {
    apart_ = true;
  } else if (mixed_) {
    fill_mixed(tables, support, neighbors);
  } else if (spheres_ > 0) {
    fill_cells(s.x, s.y, s.z, tables.reach(), tables.free_rows());
  } else {
    add_hull_balls(support.bodies(), support, neighbors);
    cells_.fill({x_, y_, z_, reach_});
  }
}

// With the first balls of those given, as many as `reach` has.
void NearSearch::fill_cells(std::span<const double> x, std::span<const double> y, std::span<const double> z,
                            std::span<const float> reach, const CellGrid::Lent& lent) {
  const std::size_t count = reach.size();
  cells_.fill({x.first(count), y.first(count), z.first(count), reach}, jobs_, std::min(threads_, kMostShares),
              lent);
}

// Spheres keep the balls that they have among themselves; those of hulls are drawn larger by as much as the
// hull of any sphere stands out of it.
void NearSearch::fill_mixed(const TablesLevel& tables, const SupportLevel& support,
                            std::span<const FullNeighbor> neighbors) {
  const Spheres& s = tables.spheres();
  double standing_out = 0.0;  // m
  for (std::size_t i = 0; i < spheres_; ++i)
    standing_out = std::max(standing_out, kBall * tables.radius(s.slot[i]) - double(s.radius[i]));
  const auto copy = [&](auto& to, const auto& from) {
    to.assign(from.begin(), from.begin() + std::ptrdiff_t(spheres_));
  };
  copy(x_, s.x), copy(y_, s.y), copy(z_, s.z), copy(reach_, tables.reach());
  add_hull_balls(support.bodies(), support, neighbors);
  drawn_reach_ = reach_;
  for (std::size_t i = spheres_; i < reach_.size(); ++i) drawn_reach_[i] += float(standing_out);
  for (std::size_t i = 0; i < spheres_; ++i)
    reach_[i] = float(hull_reach(tables, std::int64_t(i), double(tables.reach()[i])));
  fill_cells(x_, y_, z_, drawn_reach_, {});
  note_order(spheres_);
}

// m: of the hull of a sphere awake that itself reaches so far.
double NearSearch::hull_reach(const TablesLevel& tables, std::int64_t place, double reach) {
  const Spheres& s = tables.spheres();
  const auto i = std::size_t(place);
  return reach + std::max(0.0, kBall * tables.radius(s.slot[i]) - double(s.radius[i]));
}

void NearSearch::note_order(std::size_t spheres) {
  order_.clear();
  for (const std::uint32_t ball : cells_.order())
    if (ball < spheres) order_.push_back(ball);
}

void NearSearch::find_ball_pairs() {
  ball_pairs_.clear();
  for (std::int64_t part = 0; part < cells_.parts(); ++part) cells_.find_pairs(part, ball_pairs_);
}

bool NearSearch::meet(std::uint32_t a, std::uint32_t b) const {
  const double dx = x_[a] - x_[b], dy = y_[a] - y_[b], dz = z_[a] - z_[b],
               limit = double(reach_[a]) + double(reach_[b]);
  return dx * dx + dy * dy + dz * dz < limit * limit;
}

// Of two hulls. (Whoever is driven off his way looks around him anew, NearBodies::find_driven.)
bool NearSearch::pass(std::uint32_t a, std::uint32_t b) const {
  const auto way_of = [&](std::uint32_t ball) {
    return Ball{Vec3(x_[ball], y_[ball], z_[ball]), reach_[ball], half_way_[ball - spheres_]}.way();
  };
  const auto is_hull = [&](std::uint32_t ball) {
    return ball >= spheres_ && ball < spheres_ + movers_.size();
  };
  if (!is_hull(a) || !is_hull(b)) return false;
  return lodestone::pass(way_of(a), way_of(b));
}

Participant NearSearch::guest(std::int32_t slot) {
  std::int32_t& number = guest_of_slot_[std::size_t(slot)];
  if (number < 0) {
    number = std::int32_t(guests_.size());
    guests_.push_back({.slot = slot});
  }
  return Participant::statistical(own_bodies_ + std::size_t(number));
}

Participant NearSearch::participant(std::uint32_t ball, const TablesLevel& tables) {
  if (ball < spheres_) return guest(tables.spheres().slot[ball]);
  const std::size_t mover = ball - spheres_;
  return mover < movers_.size() ? Participant::statistical(std::size_t(movers_[mover]))
                                : Participant::full(mover - movers_.size());
}

void NearSearch::add_pair(std::uint32_t first, std::uint32_t second, const TablesLevel& tables) {
  const std::uint32_t low = std::min(first, second), high = std::max(first, second);
  if (low >= spheres_ + movers_.size()) return;  // two full bodies are the full level's matter
  if (mixed_ && !meet(low, high)) return;
  if (pass(low, high)) return void(any_passed_ = true);
  const Participant a = participant(low, tables), b = participant(high, tables);
  pairs_.emplace_back(a, b);
}

// Of two owners.
bool NearSearch::lets_meet(std::uint32_t first, std::uint32_t second) const {
  if (properties_ && !properties_->empty() && !may_meet(properties_->of(first), properties_->of(second)))
    return false;
  return !pair_filter_ || pair_filter_(first, second);
}

void NearSearch::find(TablesLevel& tables, SupportLevel& support, std::span<const FullNeighbor> neighbors) {
  pairs_.clear();
  forget_guests();
  any_near_ = any_passed_ = false;
  if (apart_) return tables.find_ground_contacts();
  const bool hulls =
      movers_.size() + neighbors.size() > 0 || !sleepers_.of(StatisticalModel::support).empty();
  if (hulls) guest_of_slot_.resize(std::size_t(tables.size()), -1);
  if (spheres_ > 0) {
    any_near_ = tables.find_contacts(cells_, mixed_ ? &others_ : nullptr);
    if (mixed_)
      for (std::int64_t part = 0; part < cells_.parts(); ++part)
        for (std::int64_t i = 0; i < others_[std::size_t(part)].size(); ++i)
          add_pair(others_[std::size_t(part)].first(i), others_[std::size_t(part)].second(i), tables);
    find_sleeping_hulls_near_spheres(support, tables);
  } else {
    tables.forget_contacts();
    find_ball_pairs();
    any_near_ = ball_pairs_.size() > 0;
    for (std::int64_t i = 0; i < ball_pairs_.size(); ++i)
      add_pair(ball_pairs_.first(i), ball_pairs_.second(i), tables);
  }
  find_sleeper_pairs(support, neighbors, tables);
  find_pairs_of_woken_spheres(tables);
  filter_pairs(0, [&](Participant p) {
    if (p.is_full()) return neighbors[p.index()].owner;
    return p.index() < own_bodies_ ? support.body(int(p.index())).owner
                                   : tables.owner(guests_[p.index() - own_bodies_].slot);
  });
}

}  // namespace lodestone
