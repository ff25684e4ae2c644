// What is observed of a pile. Every method, truth included, is observed alike: states sampled at 60 Hz,
// overlaps at ten samples a second.
#pragma once

#include <span>
#include <vector>

#include "tools/compare/pile_overlap.h"

namespace lodestone {

/// What is kept of one pile.
struct PileObservation {
  /// Per mass, J/kg, mean of the bodies, each kObservationStep; between the samples of longer steps on a
  /// line.
  std::vector<double> kinetic_energy;
  double sleep_time_s = 0;   ///< mean over the bodies of the last time that this is above kRestEnergyPerMass
  double mean_height_m = 0;  ///< of the centres of mass, at the end
  double max_penetration_m = 0;     ///< greatest of any pair and any body in a plane, at any time
  double end_penetration_m = 0;     ///< the same at the end
  double median_penetration_m = 0;  ///< of the pairs that overlap at the end
  /// Greatest rise of kinetic and potential energy (over the floor) above an earlier sample, over that at the
  /// start.
  double energy_rise = 0;
  int hovering = 0;  ///< bodies at rest at the end that touch nothing though moved down by 5 % of the size
  /// Bodies whose centre was out of the bin in any of the samples of overlaps, at most at once.
  int escaped = 0;
};

/// Collects a PileObservation.
class PileObserver {
 public:
  /// `shape` and `overlap` must outlive the observer. Gravity points along −z.
  PileObserver(const Shape& shape, const PileOverlap& overlap, double gravity_m_per_s2 = 9.81);

  /// In order of time, s, at 1/60 s or, for a method with longer steps, at each of them.
  void sample(double time_s, std::span<const RigidState> states);

  /// How long a pile is observed, s: 8 s for bodies up to .4 m.
  double horizon_s() const;

  PileObservation result() const;

 private:
  void observe_energy(double time_s, std::span<const RigidState> states);
  void keep_energy(double time_s, double energy);
  void observe_overlap(std::span<const RigidState> states);

  const Shape& shape_;
  const PileOverlap& overlap_;
  double gravity_, scale_;
  std::vector<double> last_stir_s_;  // of each body
  std::vector<RigidState> last_;
  double last_time_s_ = 0, next_overlap_s_ = 0, first_energy_ = 0, least_energy_ = 0;
  int samples_ = 0;
  PileObservation pile_;
};

}  // namespace lodestone
