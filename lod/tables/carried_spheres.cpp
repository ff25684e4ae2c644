#include "lod/tables/carried_spheres.h"

#include <algorithm>
#include <cmath>

#include "lod/contact/contact_solver.h"

namespace lodestone {
namespace {

constexpr double kFallingInterval = 0.05;  // s; less than anybody must lie still for
constexpr double kHangs = 0.25;            // of what a fall gives in it: who is slower does not fall
constexpr double kStandsStill = 1e-3;      // of the sleeping speed: nor does who is slower than that
constexpr double kDraws = 0.2;             // of gravity, across it: a force that draws what it acts on along,
constexpr double kDrawsOnIce = 0.005;      // at least; less where the ground's friction holds less
constexpr double kCarries = 0.05;  // sine of a plane's angle to the vertical: a steeper one carries nobody

}  // namespace

void CarriedSpheres::find_riders() {
  any_rides_ = !near_ground_.carried().empty() || !guests_.empty();
  if (!any_rides_) return;
  join_touching();
  join_carried();
  nothing_stops_ = std::int32_t(spheres_.awake);
}

void CarriedSpheres::join_touching() {
  riders_.set_all_apart(std::size_t(spheres_.awake) + 1);
  contacts_.each([&](const SphereContact& c) {
    if (c.second < std::uint32_t(spheres_.awake)) riders_.join(std::int32_t(c.first), std::int32_t(c.second));
  });
}

void CarriedSpheres::join_carried() {
  const auto nothing_stops = std::int32_t(spheres_.awake);
  for (const NearGround::Carried& carried : near_ground_.carried())
    riders_.join(std::int32_t(carried.place), nothing_stops);
  for (const std::int64_t place : guests_) riders_.join(std::int32_t(place), nothing_stops);
}

// Of the plane that it may touch; of none more than any.
double CarriedSpheres::ground_friction(std::int64_t place) const {
  if (!near_ground_.any() || place >= spheres_.awake ||
      step_.on_ground[std::size_t(place)] == std::uint8_t(GroundState::free))
    return kUnbounded;
  return scene_.materials
      .law(scene_.kind_of(place).material, near_ground_.plane(step_.plane[std::size_t(place)]).material)
      .friction;
}

void CarriedSpheres::let_go() {
  drawn_.clear(), drawn_off_.clear();
  let_go_.assign(std::size_t(spheres_.awake), LetGo::no);
  const double strength = settings_.gravity.norm();
  for (const ActingForce& force : forces_.acting().all()) {
    const Vec3 aside = strength > 0.0 ? Vec3(force.acceleration.cross(settings_.gravity) / strength)
                                      : Vec3(force.acceleration);  // as long as what is across gravity
    const auto place = std::int32_t(scene_.place_of(force.slot));
    const double held = std::max(ground_friction(place), kDrawsOnIce);
    if (aside.norm() > std::min(held, kDraws) * strength)
      (aside.norm() > held * strength ? drawn_off_ : drawn_).push_back(place);
  }
  if (drawn_.empty() && drawn_off_.empty() && near_ground_.carried().empty() && guests_.empty()) return;
  join_touching();
  const auto driven = std::int32_t(spheres_.awake);
  const auto let_all_go = [&](std::span<const std::int32_t> places, LetGo how) {
    for (const std::int32_t place : places)
      if (place < driven) riders_.join(place, driven);
    for (std::int32_t i = 0; i < driven; ++i)
      if (let_go_[std::size_t(i)] == LetGo::no && riders_.root_of(i) == riders_.root_of(driven))
        let_go_[std::size_t(i)] = how, spheres_.crowded_for[std::size_t(i)] = 0;
  };
  if (!drawn_off_.empty()) let_all_go(drawn_off_, LetGo::off);
  join_carried();
  let_all_go(drawn_, LetGo::on);
}

void CarriedSpheres::note_who_falls(double elapsed) {
  const auto intervals = [](double time) { return std::floor(time / kFallingInterval); };
  const bool is_due = intervals(elapsed) != intervals(elapsed - constants_.wide_time);
  if (!is_due || !constants_.hulls || contacts_.count() == 0) return;
  const auto carries = std::int32_t(spheres_.awake);
  const double strength = settings_.gravity.norm();
  const Vec3 up = strength > 0.0 ? Vec3(-settings_.gravity / strength) : Vec3(Vec3::Zero());
  const auto is_below = [&](const Vec3& normal) { return strength == 0.0 || normal.dot(up) >= kCarries; };
  riders_.set_all_apart(std::size_t(spheres_.awake) + 1);
  contacts_.each([&](const SphereContact& c) {
    const bool stands = c.second >= std::uint32_t(carries);  // asleep, or the ground
    if (stands && !is_below(Vec3(double(c.nx), double(c.ny), double(c.nz)))) return;
    riders_.join(std::int32_t(c.first), std::int32_t(std::min(c.second, std::uint32_t(carries))));
  });
  for (std::int64_t i = 0; i < spheres_.awake; ++i) {
    const auto state = GroundState(step_.on_ground[std::size_t(i)]);
    const bool alone = state == GroundState::moved;  // on its hull
    if (alone ||
        (state != GroundState::free && is_below(near_ground_.plane(step_.plane[std::size_t(i)]).normal)))
      riders_.join(std::int32_t(i), carries);
  }
  for (std::int64_t i = 0; i < spheres_.awake; ++i)
    if (riders_.root_of(std::int32_t(i)) != riders_.root_of(carries) && !hangs(i))
      spheres_.crowded_for[std::size_t(i)] = 0, spheres_.quiet[std::size_t(i)] = 0.0f;
}

double CarriedSpheres::moving_speed(std::int64_t place) const {
  return (step_.velocity(place) + step_.push_out(place) / constants_.wide_time).norm();
}

// By the friction of those around it, say: whatever its velocity, it goes nowhere.
bool CarriedSpheres::hangs(std::int64_t place) const {
  return moving_speed(place) <
         std::max(kHangs * settings_.gravity.norm() * kFallingInterval,
                  kStandsStill * scene_.rest_law.sleep_speed(scene_.kind_of(place).shape->radius));
}

}  // namespace lodestone
