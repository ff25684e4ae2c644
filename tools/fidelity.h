// How near a method's drops are to the ground truth's: what is observed of a drop, and the score (README, "How error is measured").
// Every method, truth included, is observed alike: states sampled at 60 Hz, whatever its own step.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "reference/shape.h"

namespace lodestone {

/// What is kept of one drop.
struct DropObservation {
  int bounces = 0;                     ///< samples between which v_n + g Δt rises by more than .3 m/s
  double rest_time_s = 0;              ///< last time that the kinetic energy per mass is above 2e-3 J/kg
  double distance_m = 0;               ///< from start to end, along the plane
  double first_rebound_m = 0;          ///< greatest height of the lowest point between the first and the second bounce
  bool at_rest = false;
  Vec3 up_in_body = Vec3::UnitZ();     ///< the plane's normal in body axes at the end
  std::vector<float> kinetic_energy;   ///< per mass, J/kg, at 60 Hz over the first 6 s (361 values)
};

/// Collects a DropObservation from samples 1/60 s apart.
class DropObserver {
 public:
  DropObserver(const Shape& shape, const Vec3& plane_normal, double gravity_m_per_s2 = 9.81);
  void sample(double time_s, const RigidState& state);
  DropObservation result() const;

 private:
  const Shape& shape_;
  Vec3 normal_;
  double gravity_;
  RigidState start_, previous_, last_;
  double last_time_ = 0, rest_time_ = 0, rebound_ = 0;
  int samples_ = 0, bounces_ = 0;
  std::vector<float> kinetic_energy_;
};

/// The score's parts against truth, and their mean over those that are defined (`parts` of them).
struct DropScore {
  double score = 0;
  int parts = 0;
  std::optional<double> w_bounces, w_rest_time, w_distance, w_peak, ke_w, tv;
};

struct ScoreWithInterval {
  DropScore value;
  std::array<double, 2> interval{};  ///< 95 % bootstrap interval of the score
};

/// Scores `method` against `truth`. W: Wasserstein-1 over the truth's deviation; KEw: Σ_t W1(KE_t) / Σ_t mean KE_t; TV: total variation over rest-pose
/// classes (12°, plus "none"). `seed` feeds the bootstrap.
ScoreWithInterval score_drops(std::span<const DropObservation> truth, std::span<const DropObservation> method, std::uint64_t seed = 1,
                              int bootstrap_samples = 200);

}  // namespace lodestone
