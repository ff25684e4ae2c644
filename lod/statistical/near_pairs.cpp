// Stages 1 and 2: which bodies are near each other, and which of them touch.
#include "lod/statistical/statistical_level_internal.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lodestone {
namespace {

constexpr double kTouching = 0.01;  // over R: a gap that is as good as none
constexpr double kFar = 0.25;       // over R: across so wide a gap fast bodies may well miss each other

// Whether two that close in at `closing` (m/s, of the first) do touch within `time`: conservative advancement of their hulls as they are turned now.
bool meet_on_their_way(const PairBody& first, const PairBody& second, const Vec3& closing, const PairContact& contact, double touching, double time) {
  constexpr int kMostSteps = 12;
  HullGap gap{contact.normal, contact.gap, -1, -1};
  double gone = 0.0;
  for (int i = 0; i < kMostSteps && gap.gap > touching; ++i) {
    const double speed = -closing.dot(gap.normal);
    if (speed <= 0.0) return false;
    gone += gap.gap / speed;
    if (gone > time) return false;
    gap = find_hull_gap(PlacedHull(*first.shape, first.position + gone * closing, first.orientation),
                        PlacedHull(*second.shape, second.position, second.orientation), gap, 1e300);
  }
  return true;
}

}  // namespace

// By place, so that nothing hangs on the order in which bodies were added.
void StatisticalLevel::Impl::sort_by_place(std::vector<std::int32_t>& slots) const {
  const auto place = [&](std::int32_t slot) {
    const Vec3& p = bodies[std::size_t(slot)].position;
    return std::array{p.x(), p.y(), p.z()};
  };
  std::ranges::sort(slots, {}, place);
}

void StatisticalLevel::Impl::add_ball(const Vec3& position, const Vec3& velocity, double radius, double dt) {
  const Vec3 half_way = (0.5 * dt) * velocity, center = position + half_way;
  ball_x.push_back(center.x()), ball_y.push_back(center.y()), ball_z.push_back(center.z());
  ball_reach.push_back(float(1.02 * radius + half_way.norm() + 0.5 * settings.gravity.norm() * dt * dt));
}

void StatisticalLevel::Impl::find_near_pairs(double dt, std::span<const FullNeighbor> neighbors) {
  movers = awake;
  sort_by_place(movers);
  ball_x.clear(), ball_y.clear(), ball_z.clear(), ball_reach.clear();
  for (const std::int32_t slot : movers) add_ball(bodies[slot].position, bodies[slot].velocity, kind_of(bodies[slot]).shape->radius, dt);
  for (const FullNeighbor& n : neighbors) add_ball(n.state.position, n.state.velocity, n.shape->radius, dt);
  cells.fill({ball_x, ball_y, ball_z, ball_reach});
  ball_pairs.clear();
  for (std::int64_t part = 0; part < cells.parts(); ++part) cells.find_pairs(part, ball_pairs);
  pairs.clear();
  for (std::int64_t i = 0; i < ball_pairs.size(); ++i) {
    const auto first = std::int32_t(ball_pairs.first(i)), second = std::int32_t(ball_pairs.second(i));
    pairs.push_back({std::min(first, second), std::max(first, second)});
  }
  find_still_pairs();
  woken = false;
  take_over_found(neighbors);
}

// Of those that move with those that sleep.
void StatisticalLevel::Impl::find_still_pairs() {
  if (still.empty()) return;
  std::vector<std::int32_t>& near = still_near;
  for (std::size_t i = 0; i < ball_x.size(); ++i) {
    const Vec3 center(ball_x[i], ball_y[i], ball_z[i]);
    const auto own_reach = double(ball_reach[i]);
    near.clear();
    still.find_near(center, own_reach, [&](std::uint32_t slot) {
      const StatisticalBody& body = bodies[slot];
      const double limit = own_reach + 1.02 * kind_of(body).shape->radius;
      if ((body.position - center).squaredNorm() < limit * limit) near.push_back(std::int32_t(slot));
    });
    sort_by_place(near);
    for (const std::int32_t slot : near) pairs.push_back({std::int32_t(i), -1 - slot});
  }
}

// A slot, or −1 − index of a full neighbour.
Participant StatisticalLevel::Impl::participant(std::int32_t of_pair) const {
  if (of_pair < 0) return -1 - of_pair;
  const auto count = std::int32_t(movers.size());
  return of_pair < count ? movers[std::size_t(of_pair)] : -1 - (of_pair - count);
}

// Pairs too many are set aside, not freed: what they have allocated serves others.
void StatisticalLevel::Impl::resize_found(std::size_t count) {
  while (found.size() > count) {
    spare_found.push_back(std::move(found.back()));
    found.pop_back();
  }
  while (found.size() < count) {
    if (spare_found.empty()) {
      found.emplace_back();
      continue;
    }
    found.push_back(std::move(spare_found.back()));
    spare_found.pop_back();
  }
}

// What is known of the pairs that were near before.
void StatisticalLevel::Impl::take_over_found(std::span<const FullNeighbor> neighbors) {
  const auto owner = [&](Participant p) { return p < 0 ? neighbors[std::size_t(-1 - p)].owner : bodies[std::size_t(p)].owner; };
  const auto comes_before = [&](Participant a, Participant b) {
    const Vec3 p = pair_body(a, neighbors).position, q = pair_body(b, neighbors).position;
    return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end());
  };
  std::swap(found, found_before);
  pair_memory.clear();
  for (const FoundPair& pair : found_before) pair_memory.add(pair.key);
  resize_found(pairs.size());
  std::size_t expected = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    // By place, so that a contact is the same whichever of its bodies is full and whichever was added first.
    Participant first = participant(pairs[i].first), second = participant(pairs[i].second);
    if (comes_before(second, first)) std::swap(first, second);
    const ContactKey key = contact_key(owner(first), owner(second));
    const std::int32_t before = pair_memory.find(key, expected);  // none, too, where they have changed places: what is known holds for their old order
    if (before < 0) found[i].forget();
    else std::swap(found[i], found_before[std::size_t(before)]), expected = std::size_t(before) + 1;
    found[i].key = key;
    found[i].first = first;
    found[i].second = second;
  }
}

PairBody StatisticalLevel::Impl::pair_body(Participant p, std::span<const FullNeighbor> neighbors) const {
  if (p < 0) {
    const FullNeighbor& n = neighbors[-1 - p];
    return {n.shape, n.state.position, n.state.orientation};
  }
  const StatisticalBody& body = bodies[p];
  return {kind_of(body).shape.get(), body.position, body.orientation};
}

Vec3 StatisticalLevel::Impl::center_velocity(Participant p, std::span<const FullNeighbor> neighbors) const {
  if (is_asleep(p, neighbors)) return Vec3::Zero();
  return p < 0 ? neighbors[std::size_t(-1 - p)].state.velocity : bodies[std::size_t(p)].velocity;
}

Vec3 StatisticalLevel::Impl::point_velocity(Participant p, const Vec3& point, std::span<const FullNeighbor> neighbors) const {
  if (p < 0) {
    const RigidState& s = neighbors[-1 - p].state;
    return s.velocity + s.angular_velocity.cross(point - s.position);
  }
  const StatisticalBody& body = bodies[p];
  if (body.motion == Motion::asleep) return Vec3::Zero();
  return body.velocity + turning[std::size_t(p)].angular_velocity.cross(point - body.position);
}

void StatisticalLevel::Impl::find_contact(double dt, std::span<const FullNeighbor> neighbors, FoundPair& pair) const {
  constexpr double kHeld = 0.02;  // over R: so far bodies take a contact along
  const PairBody a = pair_body(pair.first, neighbors), b = pair_body(pair.second, neighbors);
  const double least_radius = std::min(a.shape->radius, b.shape->radius), touching = kTouching * least_radius;
  const double moved = pair.when ? find_motion_since(*pair.when, a, b) : 0.0;
  if (pair.when && pair.contacts.empty() && pair.gap - moved > touching + find_approach(pair, dt, neighbors)) return;
  if (!pair.contacts.empty() && moved < kHeld * least_radius) return;
  const Vec3 closing = center_velocity(pair.first, neighbors) - center_velocity(pair.second, neighbors);
  thread_local HullContactSearch search;
  find_pair_contacts(a, b, pair.whole, pair.of_pieces, touching + closing.norm() * dt, search);
  pair.gap = search.gap;
  pair.when = pose_of(a, b);
  pair.contacts.clear();
  const auto meet = [&](const PairContact& contact) { return contact.gap < kFar * least_radius || meet_on_their_way(a, b, closing, contact, touching, dt); };
  for (const PairContact& contact : search.contacts)
    if (meet(contact)) pair.contacts.push_back(hold(contact, a, b));
}

// Within the step, or nearly so.
bool StatisticalLevel::Impl::closes(const FoundPair& pair, const PairContact& contact, double dt, std::span<const FullNeighbor> neighbors) const {
  const double touching = kTouching * std::min(pair_body(pair.first, neighbors).shape->radius, pair_body(pair.second, neighbors).shape->radius);
  return std::ranges::any_of(std::span(contact.manifold.points).first(std::size_t(contact.manifold.count)), [&](const ManifoldPoint& p) {
    const Vec3 velocity = point_velocity(pair.first, p.point, neighbors) - point_velocity(pair.second, p.point, neighbors);
    return p.gap + velocity.dot(contact.normal) * dt <= touching;
  });
}

void StatisticalLevel::Impl::find_contacts(double dt, std::span<const FullNeighbor> neighbors) {
  for (const std::int32_t slot : awake) bodies[slot].crowded = false;
  const auto looked_at = [&](const FoundPair& pair) {
    if (pair.first < 0 && pair.second < 0) return false;  // two full bodies are the full level's matter
    for (const Participant p : {pair.first, pair.second})
      if (p >= 0 && !near_another[std::size_t(p)] && bodies[std::size_t(p)].motion != Motion::asleep) return false;  // it has moved on
    return !(is_asleep(pair.first, neighbors) && is_asleep(pair.second, neighbors));
  };
  constexpr std::int64_t kGrain = 64;
  const auto count = std::int64_t(found.size());
  run_in_pieces(jobs, count, kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i)
      if (looked_at(found[std::size_t(i)])) find_contact(dt, neighbors, found[std::size_t(i)]);
  });
  first_contact.assign(1, 0);
  for (const FoundPair& pair : found) first_contact.push_back(first_contact.back() + (pair.contacts.empty() || !looked_at(pair) ? 0 : std::uint32_t(pair.contacts.size())));
  contacts.resize(first_contact.back());
  may_close.resize(first_contact.back());
  run_in_pieces(jobs, count, kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) {
      const FoundPair& pair = found[std::size_t(i)];
      for (std::uint32_t at = first_contact[std::size_t(i)]; at < first_contact[std::size_t(i) + 1]; ++at) {
        const HeldContact& held = pair.contacts[at - first_contact[std::size_t(i)]];
        contacts[at] = {pair.first, pair.second, follow(held, pair_body(pair.first, neighbors), pair_body(pair.second, neighbors))};
        may_close[at] = closes(pair, contacts[at].contact, dt, neighbors);
      }
    }
  });
  std::size_t kept = 0;
  for (std::size_t at = 0; at < contacts.size(); ++at) {
    if (!may_close[at]) continue;
    if (kept != at) contacts[kept] = contacts[at];
    for (const Participant p : {contacts[at].first, contacts[at].second})
      if (p >= 0) bodies[p].crowded = true, near_another[std::size_t(p)] = 1;
    ++kept;
  }
  contacts.resize(kept);
}

// Static boxes and meshes: what nears one is solved with all that it touches.
void StatisticalLevel::Impl::find_ground_solids(double dt, bool of_near_only) {
  solid_contacts.clear();
  faces_below.faces.clear();
  if (ground.solids.empty()) return faces_below.run.clear();
  faces_below.run.resize(bodies.size());  // of those awake; nobody asks about others
  for (const std::int32_t slot : awake) {
    const std::size_t before = solid_contacts.size(), faces = faces_below.faces.size();
    if (!of_near_only || near_another[std::size_t(slot)])
      find_solid_contacts(bodies[slot], kind_of(bodies[slot]), slot, ground.solids, dt, solid_contacts, faces_below.faces);
    faces_below.run[std::size_t(slot)] = {std::int32_t(faces), std::int32_t(faces_below.faces.size())};
    if (solid_contacts.size() > before) bodies[slot].crowded = true;
  }
}

void StatisticalLevel::Impl::remember_places() {
  for (const std::int32_t slot : awake) last_places[std::size_t(slot)] = bodies[std::size_t(slot)].position;
}

void StatisticalLevel::Impl::find_turning() {
  for (const std::int32_t slot : awake) {
    const StatisticalBody& body = bodies[std::size_t(slot)];
    const Shape& shape = *kind_of(body).shape;
    const Vec3 omega = body.motion == Motion::asleep ? Vec3(Vec3::Zero()) : angular_velocity(body.orientation, body.spin, shape);
    turning[std::size_t(slot)] = {omega, omega.norm() * shape.radius};
  }
}

// m: by how much their gap can shrink in `dt`, at most, if nothing strikes them.
double StatisticalLevel::Impl::find_approach(const FoundPair& pair, double dt, std::span<const FullNeighbor> neighbors) const {
  const auto turning_of = [&](Participant p) {
    if (p >= 0) return turning[std::size_t(p)].rim_speed;
    const FullNeighbor& n = neighbors[std::size_t(-1 - p)];
    return n.state.angular_velocity.norm() * n.shape->radius;
  };
  const double fall = 0.5 * settings.gravity.norm() * dt * dt;
  return ((center_velocity(pair.first, neighbors) - center_velocity(pair.second, neighbors)).norm() + turning_of(pair.first) + turning_of(pair.second)) * dt + fall;
}

double StatisticalLevel::Impl::least_radius(const FoundPair& pair, std::span<const FullNeighbor> neighbors) const {
  return std::min(pair_body(pair.first, neighbors).shape->radius, pair_body(pair.second, neighbors).shape->radius);
}

// m: of the two, at least, now. None where that was never looked for.
double StatisticalLevel::Impl::gap_left(const FoundPair& pair, std::span<const FullNeighbor> neighbors) const {
  if (!pair.when || !pair.contacts.empty()) return 0.0;
  return pair.gap - find_motion_since(*pair.when, pair_body(pair.first, neighbors), pair_body(pair.second, neighbors)) - kTouching * least_radius(pair, neighbors);
}

}  // namespace lodestone
