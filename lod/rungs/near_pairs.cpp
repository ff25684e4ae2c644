#include "lod/rungs/near_pairs.h"

#include <algorithm>
#include <cmath>

#include "lod/room.h"

namespace lodestone {
namespace {

constexpr double kTouching = 0.01;  // over R: a gap that is as good as none
constexpr double kFar = 0.25;       // over R: across so wide a gap fast bodies may well miss each other

// Whether two that close in at `closing` (m/s, of the first) do touch within `time`: conservative advancement
// of their hulls as they are turned now.
bool meet_on_their_way(const PairBody& first, const PairBody& second, const Vec3& closing,
                       const PairContact& contact, double touching, double time) {
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

// Into the cache, for who reads it soon.
template <class T>
void fetch_ahead(const T& value) {
  constexpr std::size_t kLine = 64;  // bytes
  for (std::size_t at = 0; at < sizeof value; at += kLine)
    __builtin_prefetch(reinterpret_cast<const char*>(&value) + at);
}

bool comes_before(const Vec3& p, const Vec3& q) {
  return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end());
}

}  // namespace

std::uint32_t NearPairs::take_place() {
  if (spare_.empty()) {
    append_in_room(all_);
    return std::uint32_t(all_.size() - 1);
  }
  const std::uint32_t place = spare_.back();
  spare_.pop_back();
  all_[place].forget();
  return place;
}

void NearPairs::clear() {
  spare_.insert(spare_.end(), found_.begin(), found_.end());
  found_.clear();
  forget_contacts();
}

// In the order of the step, whatever their places.
void NearPairs::archive(StateArchive& a) {
  auto count = std::uint64_t(found_.size());
  a(count);
  if (a.reading()) {
    clear();
    for (std::uint64_t i = 0; i < count; ++i) {
      const std::uint32_t place = take_place();
      a(all_[place]);
      found_.push_back(place);
    }
  } else {
    for (const std::uint32_t place : found_) a(all_[place]);
  }
  a(contacts_);
  if (a.reading()) keep_contacts();
}

// By place, so that a contact is the same on whichever rungs its bodies are and whichever was added first.
PlacedPair NearPairs::place(const ContactScene& scene, const NearPair& pair) {
  auto [first, second] = pair;
  if (comes_before(scene.position(second), scene.position(first))) std::swap(first, second);
  return {contact_key(scene.owner(first), scene.owner(second)), first, second};
}

void NearPairs::add(const ContactScene& scene, std::span<const NearPair> pairs) {
  for (const NearPair& pair : pairs) {
    found_.push_back(take_place());
    all_[found_.back()].stand_for(place(scene, pair));
    chosen_.push_back(found_.back());
  }
}

void NearPairs::take(const ContactScene& scene, std::span<const NearPair> pairs) {
  std::swap(found_, before_);
  memory_.clear();
  for (const std::uint32_t place : before_) memory_.add(all_[place].key);
  constexpr std::uint32_t kTaken = ~0u;
  found_.resize(pairs.size());
  placed_.resize(pairs.size());
  const auto count = std::int64_t(pairs.size());
  run_in_pieces(jobs_, count, kBlock, [&](std::int64_t begin, std::int64_t end) {
    for (auto i = std::size_t(begin); i < std::size_t(end); ++i) placed_[i] = place(scene, pairs[i]);
  });
  newcomers_.clear();
  std::size_t expected = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const std::int32_t before = memory_.find(
        placed_[i].key,
        expected);  // none, too, where they have changed places: what is known holds for their old order
    if (before < 0 || before_[std::size_t(before)] == kTaken) {
      newcomers_.push_back(std::uint32_t(i));
      continue;
    }
    found_[i] = std::exchange(before_[std::size_t(before)], kTaken);
    expected = std::size_t(before) + 1;
  }
  for (const std::uint32_t place : before_)
    if (place != kTaken) spare_.push_back(place);
  for (const std::uint32_t i : newcomers_) found_[i] = take_place();
  run_in_pieces(jobs_, count, kBlock, [&](std::int64_t begin, std::int64_t end) {
    for (auto i = std::size_t(begin); i < std::size_t(end); ++i) all_[found_[i]].stand_for(placed_[i]);
  });
  put_in_order();
}

// Loops over pairs that lie far from each other in memory wait for them: where too many do, all are moved to
// where the order of the step has them, in place, along the cycles of that permutation.
void NearPairs::put_in_order() {
  std::size_t leaps = 0;
  for (std::size_t i = 0; i < found_.size(); ++i) leaps += found_[i] != (i == 0 ? 0 : found_[i - 1] + 1);
  if (leaps < found_.size() / 8 + 16) return;
  const std::size_t count = found_.size();
  found_.insert(found_.end(), spare_.begin(), spare_.end());
  for (std::uint32_t i = 0; i < found_.size(); ++i) {
    if (found_[i] == i) continue;
    FoundPair first = std::move(all_[i]);
    std::uint32_t at = i;
    for (std::uint32_t from; (from = std::exchange(found_[at], at)) != i; at = from)
      all_[at] = std::move(all_[from]);
    all_[at] = std::move(first);
  }
  spare_.assign(found_.begin() + std::ptrdiff_t(count), found_.end());
  found_.resize(count);
}

Vec3 NearPairs::turning_of(const ContactScene& scene, Participant p) const {
  if (p.is_full()) return scene.neighbor(p).state.angular_velocity;
  return scene.asleep(p) ? Vec3(Vec3::Zero()) : turning_[p.index()].angular_velocity;
}

Vec3 NearPairs::point_velocity(const ContactScene& scene, Participant p, const Vec3& point) const {
  if (p.is_full()) {
    const RigidState& s = scene.neighbor(p).state;
    return s.velocity + s.angular_velocity.cross(point - s.position);
  }
  const StatisticalBody& body = scene.body(p);
  if (body.motion == Motion::asleep) return Vec3::Zero();
  return body.velocity + turning_[p.index()].angular_velocity.cross(point - body.position);
}

// How the two may close in within `time` seconds.
Enough NearPairs::find_reach(const ContactScene& scene, double time, const FoundPair& pair) const {
  return {kTouching * least_radius(scene, pair) + find_approach_by_turning(scene, pair, time),
          (scene.velocity(pair.first) - scene.velocity(pair.second) +
           time * (scene.pushed(pair.first) - scene.pushed(pair.second))) *
              time};
}

// For all that is known of the two.
bool NearPairs::stay_apart(const FoundPair& pair, const PairBody& first, const PairBody& second,
                           const Enough& reach) {
  if (!pair.when || !pair.contacts.empty()) return false;
  if (!pair.of_pieces.empty())
    return pair.gap - find_motion_since(*pair.when, first, second) > reach.anywhere();
  const GapLeft left = find_gap_left(pair.whole, *pair.when, first, second);
  return left.along > reach.along(pair.whole.normal) || left.anyhow > reach.anywhere();
}

void NearPairs::find_contact(const ContactScene& scene, double time, Pace pace, FoundPair& pair) const {
  // A sphere's orientation is coarse anyway, and spheres among others may overlap deeply, where a search is
  // dear.
  constexpr double kHeldBySphere = 0.1, kOfTurning = 0.3;
  const PairBody a = scene.pair_body(pair.first), b = scene.pair_body(pair.second);
  const double least_radius = std::min(a.shape->radius, b.shape->radius), touching = kTouching * least_radius;
  const Enough reach = find_reach(scene, time, pair);
  if (stay_apart(pair, a, b, reach)) return;
  // Points that come near by turning alone are few, and in short substeps met soon after.
  const Enough margin(is_long(pace) ? reach.still : touching + kOfTurning * (reach.still - touching),
                      reach.way);
  if (pair.when && pair.contacts.empty() && pair.of_pieces.empty() &&
      look_along(pair.whole, a, b) > margin.along(pair.whole.normal)) {
    pair.gap = pair.whole.gap;
    pair.when = pose_of(a, b);
    return;
  }
  const auto is_sphere = [&](Participant p) { return p.is_statistical() && scene.body(p).is_sphere(); };
  const auto is_eased = [&](Participant p) { return p.is_statistical() && scene.body(p).eased > 0.0f; };
  const double held = is_sphere(pair.first) || is_sphere(pair.second) ? kHeldBySphere : kTakenAlong;
  if (!pair.contacts.empty() && find_motion_since(*pair.when, a, b) < held * least_radius) return;
  const Vec3 closing = reach.way / time;
  thread_local HullContactSearch search;
  search.exact =
      !is_sphere(pair.first) && !is_sphere(pair.second) && !is_eased(pair.first) && !is_eased(pair.second);
  search.way = {reach.way, time * turning_of(scene, pair.first), time * turning_of(scene, pair.second),
                touching};
  find_pair_contacts(a, b, pair.whole, pair.of_pieces, margin, search);
  pair.gap = search.gap;
  pair.when = pose_of(a, b);
  pair.contacts.clear();
  const auto meet = [&](const PairContact& contact) {
    return contact.gap < kFar * least_radius || meet_on_their_way(a, b, closing, contact, touching, time);
  };
  for (const PairContact& contact : search.contacts)
    if (meet(contact)) pair.contacts.push_back(hold(contact, a, b));
}

// Within the time, or nearly so.
bool NearPairs::closes(const ContactScene& scene, const FoundPair& pair, const PairContact& contact,
                       double time) const {
  const double touching = kTouching * least_radius(scene, pair);
  const Vec3 given = time * (scene.pushed(pair.first) - scene.pushed(pair.second));
  return std::ranges::any_of(std::span(contact.manifold.points).first(std::size_t(contact.manifold.count)),
                             [&](const ManifoldPoint& p) {
                               const Vec3 velocity = point_velocity(scene, pair.first, p.point) -
                                                     point_velocity(scene, pair.second, p.point) + given;
                               return p.gap + velocity.dot(contact.normal) * time <= touching;
                             });
}

void NearPairs::choose(const NearMarks& near, Pace pace) {
  chosen_.clear();
  for (const std::uint32_t place : found_)
    if (near.pace(all_[place].first) == pace || near.pace(all_[place].second) == pace)
      chosen_.push_back(place);
}

void NearPairs::find_contacts(const ContactScene& scene, double time, std::span<const std::int32_t> movers,
                              NearMarks& near, Pace pace) {
  for (const std::int32_t slot : movers)
    scene.bodies[std::size_t(slot)].crowded = scene.bodies[std::size_t(slot)].carried = false;
  contacts_.resize(kept_contacts_);
  looked_at_ = 0;
  find_more_contacts(scene, time, near, pace);
}

void NearPairs::find_more_contacts(const ContactScene& scene, double time, NearMarks& near, Pace pace) {
  // Who moves at another pace has moved on, or waits until its own turn comes.
  const auto is_there = [&](Participant p) {
    return near.pace(p) == pace || (p.is_statistical() && scene.asleep(p));
  };
  const auto looked_at = [&](const FoundPair& pair) {
    if (pair.first.is_full() && pair.second.is_full())
      return false;  // two full bodies are the full level's matter
    return is_there(pair.first) && is_there(pair.second) &&
           !(scene.asleep(pair.first) && scene.asleep(pair.second));
  };
  constexpr std::size_t kAtOnce = 1024;  // so many are still in the cache when they are followed
  const std::span<const std::uint32_t> chosen = std::span(chosen_).subspan(looked_at_);
  looked_at_ = chosen_.size();
  for (std::size_t from = 0; from < chosen.size(); from += kAtOnce) {
    const auto some = chosen.subspan(from, std::min(kAtOnce, chosen.size() - from));
    first_contact_.resize(some.size() + 1);
    run_in_pieces(jobs_, std::int64_t(some.size()), kBlock, [&](std::int64_t begin, std::int64_t end) {
      for (auto i = std::size_t(begin); i < std::size_t(end); ++i) {
        FoundPair& pair = all_[some[i]];
        const bool looks = looked_at(pair);
        if (looks) find_contact(scene, time, pace, pair);
        if (looks && !pair.contacts.empty()) fetch_ahead(pair.contacts.front());
        first_contact_[i + 1] = looks ? std::uint32_t(pair.contacts.size()) : 0;
      }
    });
    follow_contacts(scene, time, some, near, pace);
  }
}

// Of these pairs, the first contacts of each but the first of all being how many the one before has.
void NearPairs::follow_contacts(const ContactScene& scene, double time, std::span<const std::uint32_t> pairs,
                                NearMarks& near, Pace pace) {
  first_contact_[0] = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) first_contact_[i + 1] += first_contact_[i];
  const std::size_t before = contacts_.size();
  resize_in_room(contacts_, before + first_contact_.back());
  may_close_.resize(first_contact_.back());
  const auto found = std::span(contacts_).subspan(before);
  run_in_pieces(jobs_, std::int64_t(pairs.size()), kBlock, [&](std::int64_t begin, std::int64_t end) {
    for (auto i = std::size_t(begin); i < std::size_t(end); ++i) {
      if (first_contact_[i] == first_contact_[i + 1]) continue;
      const FoundPair& pair = all_[pairs[i]];
      for (std::uint32_t at = first_contact_[i]; at < first_contact_[i + 1]; ++at) {
        const HeldContact& held = pair.contacts[at - first_contact_[i]];
        found[at] = {pair.first, pair.second,
                     follow(held, scene.pair_body(pair.first), scene.pair_body(pair.second))};
        may_close_[at] = closes(scene, pair, found[at].contact, time);
      }
    }
  });
  std::size_t kept = 0;
  for (std::size_t at = 0; at < found.size(); ++at) {
    if (!may_close_[at]) continue;
    if (kept != at) found[kept] = found[at];
    for (const Participant p : {found[at].first, found[at].second})
      if (p.is_statistical()) scene.body(p).crowded = true, near.set_pace(p, pace);
    ++kept;
  }
  contacts_.resize(before + kept);
}

void NearPairs::find_turning(const ContactScene& scene, std::span<const std::int32_t> bodies) {
  make_room(scene.bodies.size());
  run_in_pieces(jobs_, std::int64_t(bodies.size()), kBlock, [&](std::int64_t begin, std::int64_t end) {
    for (const std::int32_t slot : bodies.subspan(std::size_t(begin), std::size_t(end - begin))) {
      const StatisticalBody& body = scene.bodies[std::size_t(slot)];
      const Shape& shape = *scene.kind_of(body).shape;
      const Vec3 omega = body.motion == Motion::asleep ? Vec3(Vec3::Zero())
                                                       : angular_velocity(body.orientation, body.spin, shape);
      turning_[std::size_t(slot)] = {omega, omega.norm() * shape.radius};
    }
  });
}

double NearPairs::find_approach(const ContactScene& scene, const FoundPair& pair, double time) const {
  return (scene.velocity(pair.first) - scene.velocity(pair.second)).norm() * time +
         find_approach_by_turning(scene, pair, time);
}

// And by falling, since one of them may be held up.
double NearPairs::find_approach_by_turning(const ContactScene& scene, const FoundPair& pair,
                                           double time) const {
  const auto rim_speed = [&](Participant p) {
    if (p.is_statistical()) return scene.asleep(p) ? 0.0 : turning_[p.index()].rim_speed;
    return scene.neighbor(p).state.angular_velocity.norm() * scene.shape(p).radius;
  };
  const double fall = 0.5 * scene.world.gravity_strength() * time * time;
  return (rim_speed(pair.first) + rim_speed(pair.second)) * time + fall;
}

double NearPairs::gap_left(const ContactScene& scene, const FoundPair& pair) const {
  if (!pair.when || !pair.contacts.empty()) return 0.0;
  return pair.gap - find_motion_since(*pair.when, scene.pair_body(pair.first), scene.pair_body(pair.second)) -
         kTouching * least_radius(scene, pair);
}

}  // namespace lodestone
