// Stage 3f, of TablesLevel: coming to rest, the second threshold of section 3.4.
#include <algorithm>
#include <cmath>

#include "lod/tables/tables_level.h"

namespace lodestone {
namespace {

constexpr float kPartingTime = 0.05f;  // of the time
constexpr double kWedged = 4.0;        // over the energy of who is still: no more in any frame

}  // namespace

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

// Adds the time of the step to that in which it has been still, and tells whether it is long enough.
bool TablesLevel::comes_to_rest(std::int64_t i) {
  if (const SphereClips::Playing* clip = clips_.of(i)) return clip->state == SphereClips::Playing::over;
  const double gravity = settings_.gravity.norm(), radius = kind_of(i).shape->radius;
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
                     (step_.touches(i) && carried_.moving_speed(i) >= rest_law_.sleep_speed(radius));
  if (carried_.rides(i) || carried_.is_drawn_off(i)) {
    spheres_.quiet[i] = 0.0f;
    return false;
  }
  if (still && std::ranges::binary_search(set_out_, i)) return false;
  if (still)
    spheres_.quiet[i] += (parts ? kPartingTime : 1.0f) * constants_.time;
  else if (!among_others || tips || !has_less_energy(i, kWedged * still_energy))
    spheres_.quiet[i] = 0.0f;
  const bool waits_less = among_others && !rolls_on_ground(i);
  return spheres_.quiet[i] >= rest_law_.still_time(waits_less, radius, gravity) &&
         (among_others || hulls_.stands(i));
}

void TablesLevel::rest() {
  ++steps_;
  ease();
  carried_.note_who_falls(elapsed_);
  loads_.finish();
  if (!settings_.sleeping) return;
  std::ranges::sort(leaning_);
  std::ranges::sort(set_out_);
  carried_.find_riders();
  touched_sleepers_.keep_left_asleep(
      [&](std::int64_t place) { return carried_.rides(place) || carried_.is_drawn_off(place); });
  // From the end: the last one takes the place of one that falls asleep.
  for (std::int64_t i = spheres_.awake - 1; i >= 0; --i)
    if (comes_to_rest(i)) fell_asleep_.push_back(spheres_.owner[std::size_t(i)]), lay_still(i);
  touched_sleepers_.wake_left_asleep(TaskRef([&](std::int64_t slot) { wake(int(slot)); }));
}

}  // namespace lodestone
