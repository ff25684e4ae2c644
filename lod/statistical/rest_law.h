// When a body sleeps and what wakes it, on either statistical rung (section 3.4's second threshold). Among other bodies: slower than .05 m/s at R = .2 m, scaled with √R,
// for .1 s. Alone a body may still rock slowly, so it must be nearly still for longer: kinetic energy over m g R below 2.5e-4 for .5 s.
#pragma once

#include <cmath>

namespace lodestone::rest_law {

inline constexpr double kSleepSpeed = 0.05, kSleepSpeedRadius = 0.2;  // m/s, m
inline constexpr float kSleepTime = 0.1f;                             // s, among others
inline constexpr double kAloneSleepEnergy = 2.5e-4;                   // J/kg over g R
inline constexpr float kAloneSleepTime = 0.5f;                        // s
inline constexpr double kLeaningTime = 0.19;                          // s: a body that touched another so lately still leans on it, though a hair apart
inline constexpr double kWakeFactor = 2.0;                            // a sleeper wakes when touched faster than this times its sleeping speed

/// m/s.
inline double sleep_speed(double radius) { return kSleepSpeed * std::sqrt(radius / kSleepSpeedRadius); }
inline double wake_speed(double radius) { return kWakeFactor * sleep_speed(radius); }

/// J/kg: with more kinetic energy a body is not still. `gravity` in m/s².
inline double still_energy(bool among_others, double radius, double gravity) {
  const double speed = sleep_speed(radius);
  return among_others ? 0.5 * speed * speed : kAloneSleepEnergy * gravity * radius;
}

/// s: so long it must have been still.
inline float still_time(bool among_others) { return among_others ? kSleepTime : kAloneSleepTime; }

}  // namespace lodestone::rest_law
