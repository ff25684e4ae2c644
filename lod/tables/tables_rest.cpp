// Stage 3f, of TablesLevel: coming to rest, the second threshold of section 3.4.
#include <algorithm>
#include <cmath>

#include "lod/tables/tables_level.h"

namespace lodestone {
namespace {

constexpr float kPartingTime = 0.05f;      // of the time
constexpr double kWedged = 4.0;            // over the energy of who is still: no more in any frame
constexpr double kFallingInterval = 0.05;  // s; less than anybody must lie still for
constexpr double kHangs = 0.25;            // of what a fall gives in it: who is slower does not fall
constexpr double kStandsStill = 1e-3;      // of the sleeping speed: nor does who is slower than that
constexpr double kDraws = 0.2;             // of gravity, across it: a force that draws what it acts on along,
constexpr double kDrawsOnIce = 0.005;      // at least; less where the ground's friction holds less
constexpr double kCarries = 0.05;  // sine of a plane's angle to the vertical: a steeper one carries nobody

}  // namespace

// Who is moved, directly or through others, by what nothing stops: as CarriedBodies are. False: nobody.
bool TablesLevel::find_riders() {
  if (near_ground_.carried().empty() && carried_guests_.empty()) return false;
  join_touching();
  join_carried();
  return true;
}

void TablesLevel::join_touching() {
  riders_.set_all_apart(std::size_t(spheres_.awake) + 1);
  contacts_.each([&](const SphereContact& c) {
    if (c.second < std::uint32_t(spheres_.awake)) riders_.join(std::int32_t(c.first), std::int32_t(c.second));
  });
}

void TablesLevel::join_carried() {
  const auto nothing_stops = std::int32_t(spheres_.awake);
  for (const NearGround::Carried& carried : near_ground_.carried())
    riders_.join(std::int32_t(carried.place), nothing_stops);
  for (const std::int64_t place : carried_guests_) riders_.join(std::int32_t(place), nothing_stops);
}

// Of the plane that it may touch; of none more than any.
double TablesLevel::ground_friction(std::int64_t place) const {
  if (!near_ground_.any() || place >= spheres_.awake ||
      step_.on_ground[std::size_t(place)] == std::uint8_t(GroundState::free))
    return kUnbounded;
  return materials_.law(kind_of(place).material, near_ground_.plane(step_.plane[std::size_t(place)]).material)
      .friction;
}

// What lies near-still on others is brought to a stop in the world, but not with what carries it, and not
// where a force draws it or them on. Where the ground's friction does not hold that force, nobody is to
// sleep.
void TablesLevel::let_driven_go() {
  drawn_.clear(), drawn_off_.clear();
  let_go_.assign(std::size_t(spheres_.awake), LetGo::no);
  const double strength = settings_.gravity.norm();
  for (const ActingForce& force : forces_.acting().all()) {
    const Vec3 aside = strength > 0.0 ? Vec3(force.acceleration.cross(settings_.gravity) / strength)
                                      : Vec3(force.acceleration);  // as long as what is across gravity
    const auto place = std::int32_t(place_of(force.slot));
    const double held = std::max(ground_friction(place), kDrawsOnIce);
    if (aside.norm() > std::min(held, kDraws) * strength)
      (aside.norm() > held * strength ? drawn_off_ : drawn_).push_back(place);
  }
  if (drawn_.empty() && drawn_off_.empty() && near_ground_.carried().empty() && carried_guests_.empty())
    return;
  join_touching();
  const auto driven = std::int32_t(spheres_.awake);
  const auto let_go = [&](std::span<const std::int32_t> places, LetGo how) {
    for (const std::int32_t place : places)
      if (place < driven) riders_.join(place, driven);
    for (std::int32_t i = 0; i < driven; ++i)
      if (let_go_[std::size_t(i)] == LetGo::no && riders_.root_of(i) == riders_.root_of(driven))
        let_go_[std::size_t(i)] = how, spheres_.crowded_for[std::size_t(i)] = 0;
  };
  if (!drawn_off_.empty()) let_go(drawn_off_, LetGo::off);
  join_carried();
  let_go(drawn_, LetGo::on);
}

// What falls with all that it touches does not lie on it, however long they touch.
void TablesLevel::note_who_falls() {
  const auto intervals = [](double time) { return std::floor(time / kFallingInterval); };
  const bool is_due = intervals(elapsed_) != intervals(elapsed_ - constants_.wide_time);
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

// A ball, which others beside it do not hold: it may just be setting out down a slope.
bool TablesLevel::rolls_on_ground(std::int64_t place) const {
  const std::uint8_t state = step_.on_ground[std::size_t(place)];
  return constants_.hulls && kind_of(place).shape->sphere_radius &&
         state != std::uint8_t(GroundState::free) && state != std::uint8_t(GroundState::within);
}

bool TablesLevel::has_less_energy(std::int64_t place, double energy) const {
  return 0.5 * spheres_.velocity(place).squaredNorm() < energy &&  // what flies is not asked how it turns
         kinetic_energy(spheres_.body(place), *kind_of(place).shape) < energy;
}

// m/s, in this step, out of overlaps too.
double TablesLevel::moving_speed(std::int64_t place) const {
  return (step_.velocity(place) + step_.push_out(place) / constants_.wide_time).norm();
}

// By the friction of those around it, say: whatever its velocity, it goes nowhere.
bool TablesLevel::hangs(std::int64_t place) const {
  return moving_speed(place) < std::max(kHangs * settings_.gravity.norm() * kFallingInterval,
                                        kStandsStill * rest_law_.sleep_speed(kind_of(place).shape->radius));
}

void TablesLevel::rest() {
  ++steps_;
  ease();
  note_who_falls();
  loads_.finish();
  if (!settings_.sleeping) return;
  std::ranges::sort(leaning_);
  std::ranges::sort(set_out_);
  const bool any_rides = find_riders();
  const auto nothing_stops = std::int32_t(spheres_.awake);
  const auto rides = [&](std::int64_t place) {
    return any_rides && riders_.root_of(std::int32_t(place)) == riders_.root_of(nothing_stops);
  };
  const auto is_drawn_off = [&](std::int64_t place) {
    return std::size_t(place) < let_go_.size() && let_go_[std::size_t(place)] == LetGo::off;
  };
  touched_sleepers_.keep_left_asleep([&](std::int64_t place) { return rides(place) || is_drawn_off(place); });
  const double gravity = settings_.gravity.norm();
  for (std::int64_t i = spheres_.awake - 1; i >= 0;
       --i) {  // from the end: the last one takes the place of one that falls asleep
    if (const SphereClips::Playing* clip = clips_.of(i)) {
      if (clip->state == SphereClips::Playing::over)
        fell_asleep_.push_back(spheres_.owner[std::size_t(i)]), lay_still(i);
      continue;
    }
    const double radius = kind_of(i).shape->radius;
    const bool among_others =
        spheres_.since_crowded[i] < kLeaningTicks || std::ranges::binary_search(leaning_, i);
    const double still_energy = rest_law_.still_energy(among_others, radius, gravity);
    const bool still = has_less_energy(i, still_energy) ||
                       (has_less_energy(i, kWedged * still_energy) && loads_.stays_in_place(i));
    // While it slides, or is still being taken out of an overlap, its time hardly counts; one that is pressed
    // in again as far as it is taken out stays where it is. In a wedge it may go to and fro for ever: the
    // time in which it then stands still adds up.
    const bool tips = tips_ && double(tipping_.turned[std::size_t(i)]) * radius >=
                                   rest_law_.sleep_speed(radius) * constants_.wide_time;
    const bool parts = tips || step_.s[std::size_t(i)].w >= kSlides ||
                       spheres_.on_hull[i] == HullStand::rises ||
                       (step_.touches(i) && moving_speed(i) >= rest_law_.sleep_speed(radius));
    if (rides(i) || is_drawn_off(i)) {
      spheres_.quiet[i] = 0.0f;
      continue;
    }
    if (still && std::ranges::binary_search(set_out_, i)) continue;
    if (still)
      spheres_.quiet[i] += (parts ? kPartingTime : 1.0f) * constants_.time;
    else if (!among_others || tips || !has_less_energy(i, kWedged * still_energy))
      spheres_.quiet[i] = 0.0f;
    const bool waits_less = among_others && !rolls_on_ground(i);
    if (spheres_.quiet[i] < rest_law_.still_time(waits_less, radius, gravity) ||
        (!among_others && !stands(i)))
      continue;
    fell_asleep_.push_back(spheres_.owner[std::size_t(i)]);
    lay_still(i);
  }
  touched_sleepers_.wake_left_asleep(TaskRef([&](std::int64_t slot) { wake(int(slot)); }));
}

}  // namespace lodestone
