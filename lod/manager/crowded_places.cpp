#include "lod/manager/crowded_places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

namespace lodestone {
namespace {

constexpr double kThinnest = 1e-3;         // of a body's radius: the ball inside counts as so large at least
constexpr std::size_t kMembersSeen = 256;  // of the full level, the last
constexpr int kMostAtAPlace = 8;           // crowds that do not meet each other
constexpr std::int64_t kStepsBetween = 8;  // steps after which one more comes
// How full a room (room_of) is: the volume of the bodies whose centres are in it over its own. A room is
// crowded where those that wait fill it by more than kCrowded (touching cubes fill it less, however they
// lie). It is crowded, too, where some that wait overlap for certain, fill it by more than kFilled, and by
// more than kDense together with those that are there. Then bodies are let in up to kFilled. Two overlap for
// certain where they are nearer than kOverlapping times the sum of the radii of the balls inside them.
constexpr double kCrowded = 8.0, kDense = 2.0, kFilled = 1.0, kOverlapping = 0.9;

// A cell of a grid, whose width (m) is a power of two.
struct Place {
  std::array<std::int64_t, 3> cell{};
  int size = 0;
  int which = 0;  // of those there whom the caller's filter lets through each other
  friend bool operator==(const Place&, const Place&) = default;
};

struct HashOfPlace {
  std::size_t operator()(const Place& place) const {
    std::uint64_t hash = std::uint64_t(place.size) + (std::uint64_t(place.which) << 32);
    for (const std::int64_t i : place.cell)
      hash = (hash ^ std::uint64_t(i)) * 0x9e3779b97f4a7c15u, hash ^= hash >> 32;
    return hash;
  }
};

// Positions are within 1e8 m: no cell is beyond an integer unless a body is smaller than a picometre.
Place cell_at(const Vec3& position, int size) {
  Place place{.size = size};
  for (int axis = 0; axis < 3; ++axis)
    place.cell[std::size_t(axis)] = std::int64_t(std::floor(std::ldexp(position[axis], -size)));
  return place;
}

// The power of two at or below the radius of the ball inside the body.
Place place_of(const Vec3& position, const Shape& shape) {
  return cell_at(position, std::max(-30, std::ilogb(std::max(shape.inner_radius, kThinnest * shape.radius))));
}

// A cell at least as wide as the body's radius, at most twice as wide.
Place room_of(const Vec3& position, const Shape& shape) {
  return cell_at(position, std::max(-30, std::ilogb(shape.radius) + 1));
}

double volume_of(const Place& room) { return std::ldexp(1.0, 3 * room.size); }  // m³

// Where more newcomers are than may take part at once.
struct Crowd {
  Vec3 middle;          // m, position of the first of them
  const Shape* shape;   // of the first: bodies within its radius are in their way
  std::uint32_t first;  // index of that body
  int there;            // at first those that wait, later those that are in their way
};

using Crowds = std::unordered_map<Place, Crowd, HashOfPlace>;

struct Room {
  std::uint32_t first = 0;            // index of the first of those that wait
  double waiting = 0.0, there = 0.0;  // m³ of bodies
  bool overlap = false;               // of those that wait
  bool may_be_crowded(const Place& place) const {
    return waiting > (overlap ? kFilled : kCrowded) * volume_of(place);
  }
  bool is_crowded(const Place& place) const {
    return waiting > kCrowded * volume_of(place) || waiting + there > kDense * volume_of(place);
  }
};

// For certain.
bool overlap(const Vec3& first, const Shape& its, const Vec3& second, const Shape& other) {
  return (first - second).norm() < kOverlapping * (its.inner_radius + other.inner_radius);
}

// Looks two places far, at the first newcomer in each.
bool overlaps_another(const Crowds& crowds, const Vec3& position, const Shape& shape) {
  const Place its = place_of(position, shape);
  Place at = its;
  for (at.cell[0] = its.cell[0] - 2; at.cell[0] <= its.cell[0] + 2; ++at.cell[0])
    for (at.cell[1] = its.cell[1] - 2; at.cell[1] <= its.cell[1] + 2; ++at.cell[1])
      for (at.cell[2] = its.cell[2] - 2; at.cell[2] <= its.cell[2] + 2; ++at.cell[2]) {
        const auto other = crowds.find(at);
        if (other == crowds.end() || (at == its && other->second.there == 1)) continue;
        if (overlap(position, shape, other->second.middle, *other->second.shape)) return true;
      }
  return false;
}

// The crowds by the rooms that they reach into: 27 at most.
class CrowdGrid {
 public:
  void add(Crowd& crowd) {
    const Place low = room_of(crowd.middle.array() - crowd.shape->radius, *crowd.shape),
                high = room_of(crowd.middle.array() + crowd.shape->radius, *crowd.shape);
    Place at = low;
    for (at.cell[0] = low.cell[0]; at.cell[0] <= high.cell[0]; ++at.cell[0])
      for (at.cell[1] = low.cell[1]; at.cell[1] <= high.cell[1]; ++at.cell[1])
        for (at.cell[2] = low.cell[2]; at.cell[2] <= high.cell[2]; ++at.cell[2])
          crowds_[at].push_back(&crowd);
  }
  template <class Meets>
  void count(std::uint32_t body, const Vec3& position, const Place& room, const Meets& meets) {
    const auto crowds = crowds_.find(room);
    if (crowds == crowds_.end()) return;
    for (Crowd* crowd : crowds->second)
      crowd->there += (crowd->middle - position).norm() < crowd->shape->radius && meets(crowd->first, body);
  }

 private:
  std::unordered_map<Place, std::vector<Crowd*>, HashOfPlace> crowds_;
};

bool meets_its_kind(const BodyProperties& properties) {
  return !properties.kinematic &&
         may_meet(properties.category, properties.collide, properties.category, properties.collide);
}

// Whether a full body, of the last, waits there: then there are those that overlap.
bool waits_in(const BodyTable& bodies, const Place& room) {
  const auto& newcomers = bodies.newcomers();
  const std::size_t count = newcomers.size();
  for (std::size_t i = count; i > count - std::min(count, kMembersSeen); --i) {
    const std::uint32_t other = newcomers[i - 1].index;
    if (bodies.waits_at(i - 1) && bodies.level(other).choice == LevelChoice::full &&
        room_of(newcomers[i - 1].state.position, *bodies.shape(other)) == room)
      return true;
  }
  return false;
}

// Decides which newcomers wait, from those that wait and those that are there.
class NewcomerQueue {
 public:
  explicit NewcomerQueue(const Levels& levels) : levels_(levels), bodies_(levels.bodies) {}

  /// Sorts those that wait into crowds, by the place of each, and rooms. False: there are not too many
  /// anywhere.
  bool gather() {
    each_newcomer([&](std::uint32_t body, const Vec3& position, const Shape& shape) {
      const auto room = find_or_begin(rooms_, room_of(position, shape), Room{.first = body});
      if (room != rooms_.end()) room->second.waiting += shape.volume;
      const auto crowd = find_or_begin(crowds_, place_of(position, shape), Crowd{position, &shape, body, 0});
      if (crowd != crowds_.end()) ++crowd->second.there;
    });
    each_newcomer([&](std::uint32_t body, const Vec3& position, const Shape& shape) {
      const Place its = room_of(position, shape);
      const auto at = find(rooms_, its, body);
      if (at == rooms_.end()) return;
      if (Room& room = at->second; !room.overlap && room.waiting > kFilled * volume_of(its))
        room.overlap = overlaps_another(crowds_, position, shape);
    });
    std::erase_if(crowds_, [](const auto& crowd) { return crowd.second.there <= kBodiesOfAPlace; });
    std::erase_if(rooms_, [](const auto& room) { return !room.second.may_be_crowded(room.first); });
    return !crowds_.empty() || !rooms_.empty();
  }

  /// Counts the bodies that are at these crowds and rooms already.
  void count_those_there() {
    CrowdGrid grid;
    for (auto& [place, crowd] : crowds_) crowd.there = 0, grid.add(crowd);
    const auto meets = [this](std::uint32_t first, std::uint32_t body) { return is_met(first, body); };
    for (std::uint32_t body = 0; body < bodies_.indices(); ++body) {
      if (!counts(body) || bodies_.level(body).newcomer) continue;
      const Vec3 position = levels_.state(body).position;
      const Place its = room_of(position, *bodies_.shape(body));
      grid.count(body, position, its, meets);
      if (const auto room = find(rooms_, its, body); room != rooms_.end())
        room->second.there += bodies_.shape(body)->volume;
    }
    std::erase_if(rooms_, [](const auto& room) { return !room.second.is_crowded(room.first); });
  }

  /// Lets newcomers in, in order, as long as there is room; every few steps one more at each crowded place.
  /// Returns those that wait on, ascending.
  std::vector<std::uint32_t> let_in() {
    const bool more = levels_.now % kStepsBetween == 0;
    for (auto& [place, crowd] : crowds_) crowd.there = std::min(crowd.there, kBodiesOfAPlace) - more;
    for (auto& [place, room] : rooms_)
      room.there =
          std::min(room.there, kFilled * (more ? std::nextafter(volume_of(place), 0.0) : volume_of(place)));
    std::vector<std::uint32_t> waiting;
    each_newcomer([&](std::uint32_t body, const Vec3& position, const Shape& shape) {
      const auto crowd = find(crowds_, place_of(position, shape), body);
      const auto room = find(rooms_, room_of(position, shape), body);
      const bool waits = (crowd != crowds_.end() && crowd->second.there >= kBodiesOfAPlace) ||
                         (room != rooms_.end() && room->second.there >= kFilled * volume_of(room->first));
      if (waits) return waiting.push_back(body);
      if (crowd != crowds_.end()) ++crowd->second.there;
      if (room != rooms_.end()) room->second.there += shape.volume;
    });
    std::ranges::sort(waiting);
    return waiting;
  }

 private:
  bool counts(std::uint32_t body) const {
    return bodies_.alive(body) && meets_its_kind(bodies_.properties(body));
  }
  template <class Visit>
  void each_newcomer(const Visit& visit) const {
    const auto& newcomers = bodies_.newcomers();
    for (std::size_t i = 0; i < newcomers.size(); ++i)
      if (const std::uint32_t body = newcomers[i].index; bodies_.waits_at(i) && counts(body))
        visit(body, levels_.state(body).position, *bodies_.shape(body));
  }
  // Who meets the first at a place is of its crowd; who does not begins another there. Beyond kMostAtAPlace
  // crowds nobody is asked.
  bool is_met(std::uint32_t first, std::uint32_t body) const {
    const auto& may_pair = levels_.statistical_settings.pair_filter;
    return first == body || !may_pair || may_pair(first, body);
  }
  template <class Map>
  typename Map::iterator find(Map& map, Place place, std::uint32_t body) const {
    for (; place.which < kMostAtAPlace; ++place.which)
      if (const auto at = map.find(place); at != map.end() && is_met(at->second.first, body)) return at;
    return map.end();
  }
  template <class Map>
  typename Map::iterator find_or_begin(Map& map, Place place, const typename Map::mapped_type& fresh) const {
    for (; place.which < kMostAtAPlace; ++place.which)
      if (const auto at = map.try_emplace(place, fresh).first; is_met(at->second.first, fresh.first))
        return at;
    return map.end();
  }

  const Levels& levels_;
  const BodyTable& bodies_;
  Crowds crowds_;
  std::unordered_map<Place, Room, HashOfPlace> rooms_;
};

}  // namespace

std::vector<std::uint32_t> find_held_back(const Levels& levels) {
  if (levels.bodies.newcomers().size() <= kBodiesOfAPlace) return {};
  NewcomerQueue queue(levels);
  if (!queue.gather()) return {};
  queue.count_those_there();
  return queue.let_in();
}

bool is_full_place(const Levels& levels, const Vec3& position, const Shape& shape) {
  const auto& members = levels.full.members();
  const Place place = place_of(position, shape), room = room_of(position, shape);
  int there = 0;
  double volume = shape.volume;
  bool overlaps = waits_in(levels.bodies, room);
  for (std::size_t i = members.size(); i > members.size() - std::min(members.size(), kMembersSeen); --i) {
    const std::uint32_t other = members[i - 1].owner;
    const Vec3 at = levels.state(other).position;
    if (!at.allFinite()) continue;
    const Shape& its = *levels.bodies.shape(other);
    there += place_of(at, its) == place;
    overlaps = overlaps || overlap(position, shape, at, its);
    if (room_of(at, its) == room) volume += its.volume;
  }
  return there >= kBodiesOfAPlace ||
         (volume > (overlaps ? kFilled : kCrowded) * volume_of(room) && volume > shape.volume);
}

}  // namespace lodestone
