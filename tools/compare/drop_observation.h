// What is observed of a drop. Every method, truth included, is observed alike: states sampled at 60 Hz,
// whatever its own step. On a slope "up" is the plane's normal, and only gravity's part along it counts where
// a bounce is told from free flight. The thresholds are those of bodies up to .4 m; for larger ones speeds
// and times are multiplied by √λ, energies by λ (drop_scale). Smaller ones keep them, because a slower bounce
// would drown in what gravity does between two samples.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "reference/shape.h"

namespace lodestone {

inline constexpr int kKineticEnergySamples = 361;  ///< every 1/60 s over the first 6 s, both ends included

/// The first bounce, as seen between two samples, m/s.
struct FirstImpact {
  Vec3 before = Vec3::Zero();  ///< the velocity that free flight would have at the sample after it
  Vec3 after = Vec3::Zero();   ///< and the one that was found there
  Vec3 impulse() const { return after - before; }  ///< per mass
};

/// What is kept of one drop.
struct DropObservation {
  /// Pairs of successive samples between which the velocity along the normal rises by more than .3 m/s above
  /// free flight.
  int bounces = 0;
  double rest_time_s = 0;  ///< last time that the kinetic energy per mass is above kRestEnergyPerMass
  double distance_m = 0;   ///< from start to end, along the plane
  /// Greatest height of the lowest point between the first and the second bounce; 0 without a bounce.
  double first_rebound_m = 0;
  std::optional<FirstImpact> first_impact = {};  ///< none without a bounce
  bool at_rest = false;                          ///< below it for the last quarter of a second
  /// Look-ups of the statistical level outside of what its signature was measured for.
  std::int64_t table_extrapolations = 0;
  Vec3 after_a_second = Vec3::Zero();  ///< m, where its centre of mass is then
  Vec3 up_in_body = Vec3::UnitZ();     ///< the plane's normal in body axes at the end
  /// Per mass, J/kg, kKineticEnergySamples values; the last state's goes on where a drop ends earlier.
  std::vector<float> kinetic_energy;
};

/// Collects a DropObservation from samples. The plane goes through the origin.
class DropObserver {
 public:
  /// `shape` must outlive the observer. Gravity points along −z.
  DropObserver(const Shape& shape, const Vec3& plane_normal, double gravity_m_per_s2 = 9.81);
  DropObserver(Shape&&, const Vec3&, double = 9.81) = delete;

  /// In order of time, at 1/60 s or, for a method with longer steps, at each of them.
  void sample(double time_s, const RigidState& state);

  /// Below 1e-6 J/kg for the last second: later samples would only repeat the last.
  bool settled() const;

  /// How long a drop is observed, s: 10 s for bodies up to .4 m.
  double horizon_s() const;

  DropObservation result() const;

 private:
  double rise_above_free_flight(double time_s, const RigidState& state) const;
  double lowest_point(const RigidState& state) const;
  void keep_energy(double time_s, float energy);

  const Shape& shape_;
  Vec3 normal_;
  double gravity_, gravity_along_normal_;
  double scale_;  // of lengths, ≥ 1
  RigidState start_, last_;
  Vec3 after_a_second_ = Vec3::Zero();
  double last_time_ = 0, last_stir_time_ = 0, rest_time_ = 0, rebound_ = 0;
  int samples_ = 0, bounces_ = 0;
  std::optional<FirstImpact> first_impact_;
  std::vector<float> kinetic_energy_;
};

}  // namespace lodestone
