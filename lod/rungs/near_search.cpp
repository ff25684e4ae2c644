#include "lod/rungs/near_search.h"

#include <algorithm>
#include <array>

namespace lodestone {
namespace {

constexpr int kSharesMost = 16;  // of the work of filling the cells
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
                                     double dt) const {
  const Vec3 half_way = (0.5 * dt) * velocity;
  return {position + half_way, float(kBall * radius + half_way.norm() + 0.5 * gravity_.norm() * dt * dt)};
}

// A force acts on it within the step: to statistical bodies it is given before.
NearSearch::Ball NearSearch::ball_of(const FullNeighbor& body, double dt) const {
  return ball_of(body.state.position, body.state.velocity + (dt / body.mass) * body.force, body.shape->radius,
                 dt);
}

void NearSearch::add_ball(const Ball& ball) {
  x_.push_back(ball.center.x()), y_.push_back(ball.center.y()), z_.push_back(ball.center.z());
  reach_.push_back(ball.reach);
}

void NearSearch::add_hull_balls(double dt, std::span<const StatisticalBody> bodies,
                                const SupportLevel& support, std::span<const FullNeighbor> neighbors) {
  for (const std::int32_t index : movers_) {
    const StatisticalBody& body = bodies[std::size_t(index)];
    add_ball(ball_of(body.position, body.velocity, support.kind_of(body).shape->radius, dt));
  }
  for (const FullNeighbor& n : neighbors) add_ball(ball_of(n, dt));
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

void NearSearch::fill(double dt, TablesLevel& tables, const SupportLevel& support,
                      std::span<const FullNeighbor> neighbors) {
  const Spheres& s = tables.spheres();
  spheres_ = std::size_t(s.awake);
  own_bodies_ = std::size_t(support.size());
  apart_ = neighbors.empty() && stay_apart(dt, tables, support);
  if (!neighbors.empty()) rooms_.give_up();
  take_movers(support);
  mixed_ = spheres_ > 0 && movers_.size() + neighbors.size() > 0;
  x_.clear(), y_.clear(), z_.clear(), reach_.clear();
  woken_.clear(), woken_x_.clear(), woken_y_.clear(), woken_z_.clear(), woken_reach_.clear();
  const auto cells_of_spheres = [&](const auto& x, const auto& y, const auto& z, std::span<const float> reach,
                                    const CellGrid::Lent& lent) {
    cells_.fill(
        {std::span<const double>(x).first(reach.size()), std::span<const double>(y).first(reach.size()),
         std::span<const double>(z).first(reach.size()), reach},
        jobs_, std::min(threads_, kSharesMost), lent);
  };
  if (apart_) return;
  const bool may_be_apart = neighbors.empty() && !any_near_ && pairs_.empty() && tables.size() <= kMostLone;
  if (mixed_ || spheres_ == 0) sort_movers(support.bodies());
  if (may_be_apart && rooms_.are_due() && find_rooms(dt, tables, support)) {
    apart_ = true;
    return;
  }
  if (spheres_ > 0 && !mixed_) return cells_of_spheres(s.x, s.y, s.z, tables.reach(), tables.free_rows());
  if (!mixed_) {
    add_hull_balls(dt, support.bodies(), support, neighbors);
    return cells_.fill({x_, y_, z_, reach_});
  }
  // Spheres keep the balls that they have among themselves; those of hulls are drawn larger by as much as the
  // hull of any sphere stands out of it.
  double standing_out = 0.0;
  for (std::size_t i = 0; i < spheres_; ++i)
    standing_out = std::max(standing_out, kBall * tables.radius(s.slot[i]) - double(s.radius[i]));
  const auto copy = [&](auto& to, const auto& from) {
    to.assign(from.begin(), from.begin() + std::ptrdiff_t(spheres_));
  };
  copy(x_, s.x), copy(y_, s.y), copy(z_, s.z), copy(reach_, tables.reach());
  add_hull_balls(dt, support.bodies(), support, neighbors);
  drawn_reach_ = reach_;
  for (std::size_t i = spheres_; i < reach_.size(); ++i) drawn_reach_[i] += float(standing_out);
  for (std::size_t i = 0; i < spheres_; ++i) reach_[i] = float(reach_of(tables, std::int64_t(i)));
  cells_of_spheres(x_, y_, z_, drawn_reach_, {});
  note_order(spheres_);
}

// m: of a sphere awake, and of its hull.
double NearSearch::reach_of(const TablesLevel& tables, std::int64_t place) const {
  const Spheres& s = tables.spheres();
  const auto i = std::size_t(place);
  return double(tables.reach()[i]) + std::max(0.0, kBall * tables.radius(s.slot[i]) - double(s.radius[i]));
}

// Whoever moves does so within his room; whoever fell asleep since the last step did so there, and nobody
// else was laid to sleep.
bool NearSearch::stay_apart(double dt, const TablesLevel& tables, const SupportLevel& support) {
  if (!rooms_.stand()) return false;
  const std::span<const StatisticalBody> bodies = support.bodies();
  const auto radius = [&](const StatisticalBody& body) { return support.kind_of(body).shape->radius; };
  bool hold = true;
  for (const std::int32_t index : movers_) {
    if (index >= support.size() || support.is_among_awake(index)) continue;
    const StatisticalBody& body = bodies[std::size_t(index)];
    hold = hold && rooms_.holds(StatisticalModel::support, index, body.position, kBall * radius(body));
    ++rooms_.laid;
  }
  std::erase_if(lone_spheres_, [&](std::int32_t slot) {
    if (slot < tables.size() && !tables.asleep(slot)) return false;
    hold = hold && slot < tables.size() &&
           rooms_.holds(StatisticalModel::tables, slot, tables.position(slot), kBall * tables.radius(slot));
    ++rooms_.laid;
    return true;
  });
  hold = hold && rooms_.laid == sleepers_.insertions();
  for (const std::int32_t index : support.awake()) {
    if (!hold) break;
    const StatisticalBody& body = bodies[std::size_t(index)];
    const Ball ball = ball_of(body.position, body.velocity, radius(body), dt);
    hold = rooms_.holds(StatisticalModel::support, index, ball.center, double(ball.reach));
  }
  const Spheres& s = tables.spheres();
  for (std::int64_t i = 0; hold && i < s.awake; ++i)
    hold = rooms_.holds(StatisticalModel::tables, s.slot[std::size_t(i)], s.position(i), reach_of(tables, i));
  if (!hold) rooms_.give_up();
  return hold;
}

bool NearSearch::is_near_sleepers(const Vec3& center, double reach, const TablesLevel& tables,
                                  const SupportLevel& support) const {
  bool near = false;
  const auto note = [&](std::int32_t) { near = true; };
  each_still_hull(center, reach, support, note);
  if (!near) each_still_sphere(center, reach, tables, note);
  return near;
}

// Rooms for the next steps, for all movers: whether each has one to himself.
bool NearSearch::find_rooms(double dt, const TablesLevel& tables, const SupportLevel& support) {
  constexpr double kSpare = 0.25;  // over R: for what an impact gives
  const double time = rooms_.time(dt), fall = 0.5 * gravity_.norm() * time * time;
  const auto add_room = [&](StatisticalModel model, std::int32_t slot, const Vec3& center, double radius,
                            double reach, double speed) {
    const Ball room{center, float(reach + kSpare * radius + speed * time + fall)};
    add_ball(room);
    rooms_.give(model, slot, center, (1.0 - 1e-3) * double(room.reach));
  };
  rooms_.make_place(StatisticalModel::support, std::size_t(support.size()));
  rooms_.make_place(StatisticalModel::tables, std::size_t(tables.size()));
  rooms_.begin();
  const Spheres& s = tables.spheres();
  for (std::int64_t i = 0; i < s.awake; ++i) {
    const std::int32_t slot = s.slot[std::size_t(i)];
    add_room(StatisticalModel::tables, slot, s.position(i), tables.radius(slot), reach_of(tables, i),
             s.velocity(i).norm());
  }
  for (const std::int32_t index : movers_) {
    const StatisticalBody& body = support.bodies()[std::size_t(index)];
    const double radius = support.kind_of(body).shape->radius;
    add_room(StatisticalModel::support, index, body.position, radius, kBall * radius, body.velocity.norm());
  }
  cells_.fill({x_, y_, z_, reach_}, jobs_, std::min(threads_, kSharesMost));
  find_ball_pairs();
  bool apart = ball_pairs_.size() == 0;
  for (std::size_t i = 0; apart && i < x_.size(); ++i)
    apart = !is_near_sleepers(Vec3(x_[i], y_[i], z_[i]), double(reach_[i]), tables, support);
  rooms_.laid = sleepers_.insertions();
  lone_spheres_.assign(tables.awake().begin(), tables.awake().end());
  rooms_.end(apart);
  x_.clear(), y_.clear(), z_.clear(), reach_.clear();
  return apart;
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
  any_near_ = false;
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
    find_still_hulls_near_spheres(support, tables);
  } else {
    tables.forget_contacts();
    find_ball_pairs();
    any_near_ = ball_pairs_.size() > 0;
    for (std::int64_t i = 0; i < ball_pairs_.size(); ++i)
      add_pair(ball_pairs_.first(i), ball_pairs_.second(i), tables);
  }
  find_still_pairs(support, neighbors, tables);
  find_woken_pairs(tables);
  filter_pairs(0, [&](Participant p) {
    if (p.is_full()) return neighbors[p.index()].owner;
    return p.index() < own_bodies_ ? support.body(int(p.index())).owner
                                   : tables.owner(guests_[p.index() - own_bodies_].slot);
  });
}

// Calls `found` for the sleepers of `support` whose balls meet this one.
template <class Found>
void NearSearch::each_still_hull(const Vec3& center, double reach, const SupportLevel& support,
                                 const Found& found) const {
  const std::span<const StatisticalBody> bodies = support.bodies();
  sleepers_.of(StatisticalModel::support).find_near(center, reach, [&](std::uint32_t slot) {
    const double limit = reach + kBall * support.kind_of(bodies[slot]).shape->radius;
    if ((bodies[slot].position - center).squaredNorm() < limit * limit) found(std::int32_t(slot));
  });
}

template <class Found>
void NearSearch::each_still_sphere(const Vec3& center, double reach, const TablesLevel& tables,
                                   const Found& found) const {
  sleepers_.of(StatisticalModel::tables).find_near(center, reach, [&](std::uint32_t slot) {
    const double limit = reach + kBall * tables.radius(int(slot));
    if ((tables.position(int(slot)) - center).squaredNorm() < limit * limit) found(std::int32_t(slot));
  });
}

// By what it knows; false: it has to look.
bool NearSearch::add_known_still_pairs(std::size_t ball, const SupportLevel& support) {
  const std::span<const StatisticalBody> bodies = support.bodies();
  const std::int32_t mover = movers_[ball - spheres_];
  const Vec3 center(x_[ball], y_[ball], z_[ball]);
  const auto reach = double(reach_[ball]);
  const auto known = known_sleepers_.near(sleepers_, mover, center, reach);
  if (!known) return false;
  still_near_.clear();
  for (const std::int32_t slot : *known) {
    if (slot >= support.size() || !support.asleep(slot)) continue;  // it woke
    const double limit = reach + kBall * support.kind_of(bodies[std::size_t(slot)]).shape->radius;
    if ((bodies[std::size_t(slot)].position - center).squaredNorm() < limit * limit)
      still_near_.push_back(slot);
  }
  add_still_pairs(Participant::statistical(std::size_t(mover)), bodies);
  return true;
}

// With those in still_near_.
void NearSearch::add_still_pairs(Participant self, std::span<const StatisticalBody> bodies) {
  sort_by_place(bodies, still_near_);
  for (const std::int32_t slot : still_near_)
    pairs_.emplace_back(self, Participant::statistical(std::size_t(slot)));
}

// Of moving hulls with those that sleep.
void NearSearch::find_still_pairs(const SupportLevel& support, std::span<const FullNeighbor> neighbors,
                                  const TablesLevel& tables) {
  if (sleepers_.empty()) return;
  const std::span<const StatisticalBody> bodies = support.bodies();
  known_sleepers_.make_place(std::size_t(support.size()));
  for (std::size_t i = spheres_; i < x_.size(); ++i) {
    const bool full = i >= spheres_ + movers_.size();
    if (full && neighbors[i - spheres_ - movers_.size()].asleep) continue;
    if (!full && add_known_still_pairs(i, support)) continue;
    const Vec3 center(x_[i], y_[i], z_[i]);
    const auto own_reach = double(reach_[i]);
    const auto note = [&](std::int32_t slot) { still_near_.push_back(slot); };
    const Participant self = full ? Participant::full(i - spheres_ - movers_.size())
                                  : Participant::statistical(std::size_t(movers_[i - spheres_]));
    still_near_.clear();
    each_still_hull(center, own_reach, support, note);
    add_still_pairs(self, bodies);
    still_near_.clear();
    each_still_sphere(center, own_reach, tables, note);
    std::ranges::sort(still_near_);
    for (const std::int32_t slot : still_near_) pairs_.emplace_back(self, guest(slot));
    if (full) continue;
    const double way =
        2.0 * (center - bodies[self.index()].position).norm();  // the ball is half a step ahead
    known_sleepers_.look(sleepers_, std::int32_t(self.index()), center, own_reach, way,
                         [&](const Vec3& at, double reach, const auto& add) {
                           bool spheres = false;
                           each_still_hull(at, reach, support, add);
                           each_still_sphere(at, reach, tables, [&](std::int32_t) { spheres = true; });
                           return !spheres;
                         });
  }
}

// Of hulls with spheres that other spheres have just woken: these are in no cell of this step, and sleep no
// more.
void NearSearch::find_woken_pairs(const TablesLevel& tables) {
  const Spheres& s = tables.spheres();
  still_near_.clear();
  for (std::size_t i = spheres_; i < std::size_t(s.awake); ++i) still_near_.push_back(s.slot[i]);
  std::ranges::sort(still_near_);
  for (const std::int32_t slot : still_near_)
    for (std::size_t ball = spheres_; ball < x_.size(); ++ball) {
      const double limit = double(reach_[ball]) + kBall * tables.radius(slot);
      if ((tables.position(slot) - Vec3(x_[ball], y_[ball], z_[ball])).squaredNorm() >= limit * limit)
        continue;
      const Participant hull = participant(std::uint32_t(ball), tables);
      pairs_.emplace_back(guest(slot), hull);
    }
}

void NearSearch::find_still_hulls_near_spheres(const SupportLevel& support, const TablesLevel& tables) {
  const StillGrid& still = sleepers_.of(StatisticalModel::support);
  if (still.empty()) return;
  const std::span<const StatisticalBody> bodies = support.bodies();
  const Spheres& s = tables.spheres();
  for (std::size_t i = 0; i < std::size_t(s.awake); ++i) {  // with those that others have just woken
    const Vec3 center = s.position(std::int64_t(i));
    const double own_reach = reach_of(tables, std::int64_t(i));
    still_near_.clear();
    still.find_near(center, own_reach, [&](std::uint32_t slot) {
      const double limit = own_reach + kBall * support.kind_of(bodies[slot]).shape->radius;
      if ((bodies[slot].position - center).squaredNorm() < limit * limit)
        still_near_.push_back(std::int32_t(slot));
    });
    sort_by_place(bodies, still_near_);
    for (const std::int32_t slot : still_near_)
      pairs_.emplace_back(guest(s.slot[i]), Participant::statistical(std::size_t(slot)));
  }
}

}  // namespace lodestone
