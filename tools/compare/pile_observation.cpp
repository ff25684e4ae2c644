#include "tools/compare/pile_observation.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "reference/drop_trial.h"
#include "reference/error.h"
#include "reference/free_rotation.h"
#include "tools/compare/drop_observation.h"

namespace lodestone {
namespace {

constexpr double kPileHorizon = 8.0;        // s
constexpr double kPileRestDuration = 0.25;  // s
constexpr double kHoverDrop = 0.05;         // over the size
constexpr double kOverlapInterval = 0.1;    // s: a look at every pair costs more than a step

}  // namespace

PileObserver::PileObserver(const Shape& shape, const PileOverlap& overlap, double gravity_m_per_s2)
    : shape_(shape),
      overlap_(overlap),
      gravity_(gravity_m_per_s2),
      scale_(std::max(1.0, drop_scale(shape))) {}

void PileObserver::sample(double time_s, std::span<const RigidState> states) {
  observe_energy(time_s, states);
  if (time_s > next_overlap_s_ - 0.5 * kObservationStep) {
    observe_overlap(states);
    next_overlap_s_ += kOverlapInterval;
  }
  ++samples_;
  last_time_s_ = time_s;
  last_.assign(states.begin(), states.end());
}

void PileObserver::observe_energy(double time_s, std::span<const RigidState> states) {
  last_stir_s_.resize(states.size(), 0.0);
  double kinetic = 0.0, potential = 0.0;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const double energy = kinetic_energy(shape_, states[i]);
    if (energy > kRestEnergyPerMass * scale_) last_stir_s_[i] = time_s;
    kinetic += energy / double(states.size());
    potential += gravity_ * states[i].position.z() / double(states.size());
  }
  keep_energy(time_s, kinetic);
  const double total = kinetic + potential;
  if (samples_ == 0) first_energy_ = least_energy_ = total;
  pile_.energy_rise = std::max(pile_.energy_rise, (total - least_energy_) / first_energy_);
  least_energy_ = std::min(least_energy_, total);
}

void PileObserver::keep_energy(double time_s, double energy) {
  std::vector<double>& kept = pile_.kinetic_energy;
  const auto samples = std::size_t(std::lround(time_s / kObservationStep)) + 1;
  while (kept.size() < samples) {
    const double last = kept.empty() ? energy : kept.back();
    kept.push_back(last + (energy - last) / double(samples - kept.size()));
  }
}

void PileObserver::observe_overlap(std::span<const RigidState> states) {
  pile_.max_penetration_m = std::max(pile_.max_penetration_m, overlap_.deepest(states));
  pile_.escaped = std::max(pile_.escaped, overlap_.count_escaped(states));
}

double PileObserver::horizon_s() const { return kPileHorizon * std::sqrt(scale_); }

PileObservation PileObserver::result() const {
  check_that(samples_ > 0, "a pile was sampled");
  PileObservation pile = pile_;
  const double bodies = double(last_.size());
  pile.sleep_time_s = std::accumulate(last_stir_s_.begin(), last_stir_s_.end(), 0.0) / bodies;
  for (const RigidState& state : last_) pile.mean_height_m += state.position.z() / bodies;
  std::vector<char> at_rest;
  for (const double stir : last_stir_s_)
    at_rest.push_back(last_time_s_ - stir >= kPileRestDuration * std::sqrt(scale_));
  pile.end_penetration_m = overlap_.deepest(last_);
  pile.median_penetration_m = overlap_.median_depth(last_);
  pile.hovering = overlap_.count_hovering(last_, at_rest, kHoverDrop * shape_.size);
  return pile;
}

}  // namespace lodestone
