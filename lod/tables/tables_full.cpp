// Spheres that touch bodies of the full level: few, so they are solved together with those one by one, by the crowd's solver.
#include "lod/tables/tables_level.h"

#include <algorithm>

namespace lodestone {
namespace {

constexpr double kFullSphere = 0.8;  // radius over R of the sphere that stands for a full body
constexpr double kTouching = 0.01;   // m over R
constexpr double kWakeFactor = 2.0;  // of the sleeping speed

PairBody pair_body(const FullNeighbor& n) { return {n.shape, n.state.position, n.state.orientation, kFullSphere * n.shape->radius}; }

}  // namespace

void TablesLevel::find_full_touches(std::span<FullNeighbor> neighbors) {
  full_touches_.clear();
  near_full_slot_.clear();
  const double time = double(constants_.time);
  for (std::size_t k = 0; k < neighbors.size(); ++k) {
    FullNeighbor& n = neighbors[k];
    const PairBody full = pair_body(n);
    const double reach = full.sphere_radius + n.state.velocity.norm() * time + 0.5 * settings_.gravity.norm() * time * time;
    std::vector<std::uint32_t> near;  // slots
    cells_.find_near(full.position, reach, [&](std::uint32_t place) { near.push_back(std::uint32_t(spheres_.slot[place])); });
    still_.find_near(full.position, reach, [&](std::uint32_t slot) { near.push_back(slot); });
    std::ranges::sort(near);
    for (const std::uint32_t slot : near) {
      const std::int64_t place = spheres_.place_of_slot[slot];
      const bool sleeps = place >= spheres_.awake;
      if (sleeps && n.asleep) continue;
      const BodyKind& kind = kind_of(place);
      const StatisticalBody body = spheres_.body(place);
      const PairBody own{kind.shape.get(), body.position, body.orientation, double(body.sphere_radius)};
      const bool first = body.owner < n.owner;  // the lower owner first, so that a contact is the same whichever of its bodies is full
      const Vec3 closing = body.velocity - n.state.velocity;
      const double touching = kTouching * std::min(kind.shape->radius, n.shape->radius);
      const auto contact = find_sphere_contact(first ? own : full, first ? full : own, touching + closing.norm() * time);
      if (!contact) continue;
      const Vec3& point = contact->manifold.points[0].point;
      const Vec3 own_speed = body.velocity + angular_velocity(body.orientation, body.spin, *kind.shape).cross(point - body.position);
      const Vec3 full_speed = n.state.velocity + n.state.angular_velocity.cross(point - n.state.position);
      const double nearing = (first ? 1.0 : -1.0) * (own_speed - full_speed).dot(contact->normal);
      if (contact->gap + nearing * time > touching) continue;
      if (sleeps && full_speed.norm() > kWakeFactor * sleep_speed(place)) wake(int(slot));
      if (n.asleep && own_speed.norm() > kWakeFactor * 0.05 * std::sqrt(n.shape->radius / 0.2)) n.asleep = false;
      auto known = std::ranges::find(near_full_slot_, slot);
      const auto index = Participant(known - near_full_slot_.begin());
      if (known == near_full_slot_.end()) near_full_slot_.push_back(slot);
      const Participant other = -1 - Participant(k);
      full_touches_.push_back({first ? index : other, first ? other : index, *contact});
    }
  }
}

void TablesLevel::meet_full(std::span<FullNeighbor> neighbors, std::span<const FullContact> full_contacts, ContactTally& tally) {
  if (full_touches_.empty()) return;
  const double time = double(constants_.time);
  near_full_.clear();
  for (const std::uint32_t slot : near_full_slot_) {
    const std::int64_t i = spheres_.place_of_slot[slot];
    StatisticalBody body = spheres_.body(i);
    body.crowded = true;
    if (body.motion == Motion::settling) body.motion = Motion::dynamic;
    if (body.motion != Motion::asleep && step_.touches(i)) {
      body.velocity = step_.velocity(i) - settings_.gravity * time;
      body.spin += step_.added_spin(i);
      body.position += step_.push_out(i);
    }
    near_full_.push_back(body);
  }
  tally += crowd_.step({near_full_, kinds_.kinds, neighbors, full_contacts, {}, world(), StatisticalModel::tables, time}, full_touches_, {});
  for (std::size_t k = 0; k < near_full_.size(); ++k) {
    const StatisticalBody& body = near_full_[k];
    if (body.motion == Motion::asleep) continue;
    const std::int64_t i = spheres_.place_of_slot[near_full_slot_[k]];
    spheres_.put(i, body);
    step_.p[std::size_t(i)].w = std::max(1.0f, step_.p[std::size_t(i)].w);
    step_.on_ground[std::size_t(i)] = std::uint8_t(GroundState::moved);
    // What is lost in rounding to floats goes to the full body, so that momentum is exact.
    const Vec3 lost = kind_of(i).mass * (body.velocity - spheres_.velocity(i));
    const auto touch = std::ranges::find_if(full_touches_, [&](const CrowdContact& c) { return std::max(c.first, c.second) == Participant(k); });
    FullNeighbor& n = neighbors[std::size_t(-1 - std::min(touch->first, touch->second))];
    if (!n.asleep) n.push.linear += lost;
  }
}

}  // namespace lodestone
