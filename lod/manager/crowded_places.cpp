#include "lod/manager/crowded_places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

namespace lodestone {
namespace {

constexpr double kThinnest = 1e-3;         // of a body's radius: the ball inside counts as so large at least
constexpr std::size_t kMembersSeen = 256;  // of the full level, the last
constexpr std::int64_t kStepsBetween = 8;  // steps after which one more comes

// A cell of a grid, whose width (m) is the power of two at or below the radius of the ball inside the body.
struct Place {
  std::array<std::int64_t, 3> cell{};
  int size = 0;
  friend bool operator==(const Place&, const Place&) = default;
};

struct HashOfPlace {
  std::size_t operator()(const Place& place) const {
    std::uint64_t hash = std::uint64_t(place.size);
    for (const std::int64_t i : place.cell)
      hash = (hash ^ std::uint64_t(i)) * 0x9e3779b97f4a7c15u, hash ^= hash >> 32;
    return hash;
  }
};

// Positions are within 1e8 m: no cell is beyond an integer unless a body is smaller than a picometre.
Place place_of(const Vec3& position, const Shape& shape) {
  const int size = std::max(-30, std::ilogb(std::max(shape.inner_radius, kThinnest * shape.radius)));
  Place place{.size = size};
  for (int axis = 0; axis < 3; ++axis)
    place.cell[std::size_t(axis)] = std::int64_t(std::floor(std::ldexp(position[axis], -size)));
  return place;
}

bool meets_its_kind(const BodyProperties& properties) {
  return !properties.kinematic &&
         may_meet(properties.category, properties.collide, properties.category, properties.collide);
}

}  // namespace

std::vector<std::uint32_t> find_held_back(const Levels& levels) {
  const BodyTable& bodies = levels.bodies;
  const auto& newcomers = bodies.newcomers();
  if (newcomers.size() <= kBodiesOfAPlace) return {};
  const auto place_of_body = [&](std::uint32_t body) {
    return place_of(levels.state(body).position, *bodies.shape(body));
  };
  const auto counts = [&](std::uint32_t body) {
    return bodies.alive(body) && meets_its_kind(bodies.properties(body));
  };
  std::unordered_map<Place, int, HashOfPlace>
      taken;  // how many are there; of places where more than may be want to
  for (std::size_t i = 0; i < newcomers.size(); ++i)
    if (bodies.waits_at(i) && counts(newcomers[i].index)) ++taken[place_of_body(newcomers[i].index)];
  std::erase_if(taken, [](const auto& place) { return place.second <= kBodiesOfAPlace; });
  if (taken.empty()) return {};
  const int more = levels.now % kStepsBetween == 0;
  for (auto& place : taken) place.second = -more;
  for (std::uint32_t body = 0; body < bodies.indices(); ++body) {
    if (!counts(body) || bodies.level(body).newcomer) continue;
    if (const auto place = taken.find(place_of_body(body)); place != taken.end())
      place->second = std::min(place->second + 1, kBodiesOfAPlace - more);
  }
  std::vector<std::uint32_t> held;
  for (std::size_t i = 0; i < newcomers.size(); ++i) {
    if (!bodies.waits_at(i) || !counts(newcomers[i].index)) continue;
    const auto place = taken.find(place_of_body(newcomers[i].index));
    if (place != taken.end() && ++place->second > kBodiesOfAPlace) held.push_back(newcomers[i].index);
  }
  std::ranges::sort(held);
  return held;
}

bool is_full_place(const Levels& levels, const Vec3& position, const Shape& shape) {
  const auto& members = levels.full.members();
  const Place place = place_of(position, shape);
  int there = 0;
  for (std::size_t i = members.size();
       i > members.size() - std::min(members.size(), kMembersSeen) && there < kBodiesOfAPlace; --i) {
    const std::uint32_t other = members[i - 1].owner;
    const Vec3 at = levels.state(other).position;
    there += at.allFinite() && place_of(at, *levels.bodies.shape(other)) == place;
  }
  return there >= kBodiesOfAPlace;
}

}  // namespace lodestone
