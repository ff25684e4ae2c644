// Of NearSearch: steps in which nobody can be near anybody, since each mover has a room to itself
// (lone_rooms.h).
#include <algorithm>

#include "lod/rungs/near_search.h"

namespace lodestone {

// Finds a room for each mover for the next steps. Returns whether each has one to itself.
bool NearSearch::find_rooms(const TablesLevel& tables, const SupportLevel& support) {
  constexpr double kSpare = 0.25;  // over R: for what an impact gives
  const double time = rooms_.time(dt_), fall = 0.5 * gravity_.norm() * time * time;
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
    add_room(StatisticalModel::tables, slot, s.position(i), tables.radius(slot),
             hull_reach(tables, i, tables.still_reach(i)), s.velocity(i).norm());
  }
  for (const std::int32_t index : movers_) {
    const StatisticalBody& body = support.bodies()[std::size_t(index)];
    const double radius = support.kind_of(body).shape->radius;
    add_room(StatisticalModel::support, index, body.position, radius, kBall * radius, body.velocity.norm());
  }
  bool apart = true;
  for (std::uint32_t i = 1; apart && i < x_.size(); ++i) apart = !meet(i - 1, i);  // mostly, if any meet
  if (apart) {
    cells_.fill({x_, y_, z_, reach_}, jobs_, std::min(threads_, kMostShares));
    find_ball_pairs();
    apart = ball_pairs_.size() == 0;
  }
  for (std::size_t i = 0; apart && i < x_.size(); ++i)
    apart = !is_near_sleepers(Vec3(x_[i], y_[i], z_[i]), double(reach_[i]), tables, support);
  rooms_.laid = sleepers_.insertions();
  lone_spheres_.assign(tables.awake().begin(), tables.awake().end());
  rooms_.end(apart);
  x_.clear(), y_.clear(), z_.clear(), reach_.clear();
  return apart;
}

// Whether the rooms still hold: all that moves has stayed within its room, what fell asleep since the last
// step did so in its room, and nobody else was put to sleep.
bool NearSearch::stay_apart(const TablesLevel& tables, const SupportLevel& support) {
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
    const Ball ball = ball_of(body.position, body.velocity, radius(body), 0.0);
    hold = rooms_.holds(StatisticalModel::support, index, ball.center, double(ball.reach));
  }
  const Spheres& s = tables.spheres();
  for (std::int64_t i = 0; hold && i < s.awake; ++i)
    hold = rooms_.holds(StatisticalModel::tables, s.slot[std::size_t(i)], s.position(i),
                        hull_reach(tables, i, tables.still_reach(i)));
  if (!hold) rooms_.give_up();
  return hold;
}

bool NearSearch::is_near_sleepers(const Vec3& center, double reach, const TablesLevel& tables,
                                  const SupportLevel& support) const {
  bool near = false;
  const auto note = [&](std::int32_t) { near = true; };
  each_sleeping_hull(center, reach, support, note);
  if (!near) each_sleeping_sphere(center, reach, tables, note);
  return near;
}

}  // namespace lodestone
