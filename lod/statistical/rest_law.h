// When a body sleeps and what wakes it, on either statistical rung (section 3.4's second threshold). Among
// other bodies: slower than .05 m/s at R = .2 m, scaled with √R, for .1 s. Alone a body may still rock
// slowly, so it must be nearly still for longer: kinetic energy over m g R below 2.5e-4 for .5 s. What is
// larger, or under less gravity, must be so for longer (reference/rocking.h), and slower under less gravity.
// Other thresholds (SleepThresholds) scale all of these alike.
#pragma once

#include <cmath>

#include "lod/body.h"
#include "reference/rocking.h"

namespace lodestone {

class RestLaw {
 public:
  static constexpr double kSleepSpeedRadius = 0.2;     // m
  static constexpr double kAloneSleepEnergy = 2.5e-4;  // J/kg over g R
  static constexpr double kAloneSleepTime = 5.0;       // of the time among others
  // s: a body that touched another so lately still leans on it, though a hair apart.
  static constexpr double kLeaningTime = 0.19;
  // A sleeper wakes when touched faster than this times its sleeping speed.
  static constexpr double kWakeFactor = 2.0;
  static constexpr double kSettingOut = 0.01;  // of the gravity: what gains speed faster than so sets out

  explicit RestLaw(const SleepThresholds& thresholds = {})
      : speed_(thresholds.speed),
        alone_energy_(kAloneSleepEnergy * square(thresholds.speed / SleepThresholds{}.speed)),
        time_(float(thresholds.time)),
        alone_time_(float(kAloneSleepTime * thresholds.time)) {}

  /// m/s.
  double sleep_speed(double radius) const { return speed_ * std::sqrt(radius / kSleepSpeedRadius); }
  double wake_speed(double radius) const { return kWakeFactor * sleep_speed(radius); }
  /// m/s, of a body of the full level, of any size. `gravity` in m/s².
  double full_sleep_speed(double gravity) const { return falling_speed_share(gravity) * speed_; }

  /// J/kg: with more kinetic energy a body is not still. `gravity` in m/s².
  double still_energy(bool among_others, double radius, double gravity) const {
    const double speed = falling_speed_share(gravity) * sleep_speed(radius);
    return among_others ? 0.5 * speed * speed : alone_energy_ * gravity * radius;
  }

  /// Whether a body sets out rather than comes to rest: a stack that begins to slide is as slow as one that
  /// ceases to. It does if it has gained `gain`, m/s, without a break over the last `rising` seconds, at
  /// least half of the `still_time` after which it would sleep. `gravity` in m/s².
  static bool sets_out(float gain, float rising, float still_time, double gravity) {
    return rising >= 0.5f * still_time && double(gain) > kSettingOut * gravity * double(rising);
  }

  /// s, among others: no body less.
  float least_still_time() const { return time_; }
  /// s: so long it must have been still. `gravity` in m/s².
  float still_time(bool among_others, double radius, double gravity) const {
    return (among_others ? time_ : alone_time_) * float(rocking_slowness(radius, gravity));
  }

 private:
  static double square(double x) { return x * x; }
  double speed_;         // m/s, at kSleepSpeedRadius
  double alone_energy_;  // J/kg over g R
  float time_, alone_time_;
};

}  // namespace lodestone
