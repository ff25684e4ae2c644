// Stage 7 of TablesLevel's step: coming to rest, the second threshold of section 3.4.
#include "lod/tables/tables_level.h"

#include <cmath>

namespace lodestone {
namespace {

// Among other bodies: slower than .05 m/s at R = .2 m, scaled with √R, for .1 s. Alone a body may still rock slowly, so it must be nearly still for longer: kinetic
// energy over m g R below 2.5e-4 for .5 s.
constexpr double kSleepSpeed = 0.05, kSleepSpeedRadius = 0.2;
constexpr float kSleepTime = 0.1f;
constexpr double kAloneSleepEnergy = 2.5e-4;
constexpr float kAloneSleepTime = 0.5f;
constexpr int kLeaningSteps = 12;  // a body that touched another so lately still leans on it, though a hair apart

}  // namespace

double TablesLevel::sleep_speed(std::int64_t place) const { return kSleepSpeed * std::sqrt(kind_of(place).shape->radius / kSleepSpeedRadius); }

void TablesLevel::rest() {
  if (!settings_.sleeping) return;
  const double gravity = settings_.gravity.norm();
  for (std::int64_t i = spheres_.awake - 1; i >= 0; --i) {  // from the end: the last one takes the place of one that falls asleep
    const double speed = sleep_speed(i);
    const bool among_others = spheres_.since_crowded[i] < kLeaningSteps;
    const double limit = among_others ? 0.5 * speed * speed : kAloneSleepEnergy * gravity * kind_of(i).shape->radius;
    const StatisticalBody body = spheres_.body(i);
    // Nor while it is still being taken out of an overlap; one that is pressed in again as far as it is taken out stays where it is.
    const double out = (step_.velocity(i) + step_.push_out(i) / constants_.wide_time).norm();
    const bool still = kinetic_energy(body, *kind_of(i).shape) < limit && (!step_.touches(i) || out < speed);
    spheres_.quiet[i] = still ? spheres_.quiet[i] + constants_.time : 0.0f;
    if (spheres_.quiet[i] >= (among_others ? kSleepTime : kAloneSleepTime)) put_to_sleep(i);
  }
}

}  // namespace lodestone
