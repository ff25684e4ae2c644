#include "lod/tables/ground_strikers.h"

#include <algorithm>

#include "reference/free_rotation.h"

namespace lodestone {
namespace {

constexpr std::size_t kFewStrikers = 64;
constexpr std::uint8_t kStrikes = 1, kFollowed = 2;

}  // namespace

// Whether contacts with planes would find no impact, but this one.
bool GroundStrikers::strikes(std::int64_t place) const {
  if (step_.on_ground[std::size_t(place)] != std::uint8_t(GroundState::near) || !step_.touches(place))
    return false;
  const auto number = step_.plane[std::size_t(place)];
  const Vec3 against = spheres_.velocity(place) - near_ground_.planes().velocity(std::size_t(number));
  return against.dot(near_ground_.plane(number).normal) < -double(scene_.bounce_velocity());
}

// Whom of those that strike another would meet in this step once it stopped, as the ground goes, with nothing
// that holds the two apart yet.
void GroundStrikers::find_followed() {
  const auto awake = std::uint32_t(spheres_.awake);
  const float bounce = scene_.bounce_velocity();
  followed_.assign(std::size_t(awake), 0);
  for (const std::uint32_t place : striking_) followed_[place] = kStrikes;
  const auto note = [&](std::uint32_t place, std::uint32_t other, const SphereContact& c, float side) {
    if (followed_[place] == 0) return;
    const Vec3 against =
        spheres_.velocity(other) - near_ground_.planes().velocity(std::size_t(step_.plane[place]));
    const float speed =
        side * (float(against.x()) * c.nx + float(against.y()) * c.ny + float(against.z()) * c.nz);
    if (speed > bounce && c.gap < speed * constants_.time) followed_[place] = kFollowed;
  };
  contacts_.each([&](const SphereContact& c) {
    if (c.second >= awake || c.closing < -bounce || !scene_.is_unloaded(c.first, c.second, c.impulse)) return;
    note(c.second, c.first, c, -1.0f), note(c.first, c.second, c, 1.0f);
  });
}

std::span<const std::uint32_t> GroundStrikers::find(std::span<const Guest> guests) {
  if (!constants_.hulls || !near_ground_.any()) return {};
  striking_.clear();
  striking_.reserve(kFewStrikers), strikers_.reserve(kFewStrikers);
  followed_.reserve(std::size_t(spheres_.awake));
  step_.each(GroundState::near, 0, spheres_.awake, [&](std::int64_t i) {
    if (strikes(i)) striking_.push_back(std::uint32_t(i));
  });
  if (striking_.empty()) return {};
  find_followed();
  for (const Guest& guest : guests)
    if (const std::size_t place = scene_.place_of(guest.slot); place < followed_.size()) followed_[place] = 0;
  std::erase_if(striking_, [&](std::uint32_t place) { return followed_[place] != kFollowed; });
  return striking_;
}

void GroundStrikers::add(std::int64_t place) {
  const auto i = std::size_t(place);
  const StatisticalBody body = spheres_.body(place);
  const Vec3 turning = double(spheres_.radius[i]) *
                       angular_velocity(body.orientation, body.spin, *scene_.kind_of(place).shape);
  const auto set = [](lane::Row& row, const Vec3& v) {
    row.x = float(v.x()), row.y = float(v.y()), row.z = float(v.z());
  };
  set(step_.p[i], body.velocity), set(step_.u[i], turning), set(step_.s[i], Vec3::Zero());
  const Vec3& normal = near_ground_.plane(step_.plane[i]).normal;
  strikers_.push_back({place, normal, body.velocity.dot(normal)});
}

void GroundStrikers::hold() {
  for (Striker& striker : strikers_) {
    const double speed = step_.velocity(striker.place).dot(striker.normal),
                 given = std::max(0.0, striker.given + striker.leaves - speed);
    lane::Row& added = step_.a[std::size_t(striker.place)];
    const Vec3 change = (given - striker.given) * striker.normal;
    added.x += float(change.x()), added.y += float(change.y()), added.z += float(change.z());
    striker.given = given;
  }
}

void GroundStrikers::finish(ContactTally& tally) {
  hold();
  for (const Striker& striker : strikers_) {
    const std::int64_t i = striker.place;
    StatisticalBody body = spheres_.body(i);
    const Vec3 out = step_.push_out(i), velocity = step_.velocity(i);
    body.position += constants_.wide_time * (velocity - body.velocity) + out -
                     std::min(0.0, out.dot(striker.normal)) * striker.normal;
    body.velocity = velocity;
    body.spin += step_.added_spin(i);
    spheres_.put(i, body);
    scene_.recover(i, tally);
  }
}

}  // namespace lodestone
