#include "tools/compare/drop_observation.h"

#include <algorithm>
#include <cmath>

#include "reference/drop_trial.h"
#include "reference/error.h"
#include "reference/free_rotation.h"

namespace lodestone {
namespace {

constexpr double kHorizon = 10.0;    // s
constexpr double kBounceRise = 0.3;  // m/s; a resting contact rises by gΔt = .16 m/s …
constexpr double kRestingRise =
    1.5;  // … or, between samples farther apart than 1/60 s, by this times gΔt at most
constexpr double kRestDuration = 0.25;    // s, longer than a rocking body stands still at its turning points
constexpr double kSettledEnergy = 1e-6;   // J/kg
constexpr double kSettledDuration = 1.0;  // s

}  // namespace

DropObserver::DropObserver(const Shape& shape, const Vec3& plane_normal, double gravity_m_per_s2)
    : shape_(shape),
      normal_(plane_normal),
      gravity_(gravity_m_per_s2),
      gravity_along_normal_(gravity_m_per_s2 * plane_normal.z()),
      scale_(std::max(1.0, drop_scale(shape))) {
  kinetic_energy_.reserve(kKineticEnergySamples);
}

void DropObserver::sample(double time_s, const RigidState& state) {
  if (samples_++ == 0) start_ = last_ = state;
  const double resting = kRestingRise * gravity_along_normal_ * (time_s - last_time_);
  if (rise_above_free_flight(time_s, state) > std::max(kBounceRise * std::sqrt(scale_), resting)) {
    if (++bounces_ == 1)
      first_impact_ =
          FirstImpact{last_.velocity - gravity_ * (time_s - last_time_) * Vec3::UnitZ(), state.velocity};
  }
  if (bounces_ == 1) rebound_ = std::max(rebound_, lowest_point(state));
  const double energy = kinetic_energy(shape_, state);
  if (energy > kRestEnergyPerMass * scale_) rest_time_ = time_s;
  if (energy > kSettledEnergy * scale_) last_stir_time_ = time_s;
  keep_energy(time_s, float(energy));
  if (time_s <= std::sqrt(scale_) + 1e-9) after_a_second_ = state.position;
  last_time_ = time_s;
  last_ = state;
}

double DropObserver::rise_above_free_flight(double time_s, const RigidState& state) const {
  return normal_.dot(state.velocity - last_.velocity) + gravity_along_normal_ * (time_s - last_time_);
}

double DropObserver::lowest_point(const RigidState& state) const {
  const Vec3 down = -(state.orientation.conjugate() * normal_);
  if (shape_.sphere_radius) return normal_.dot(state.position) - *shape_.sphere_radius;
  const int vertex = find_support(shape_.hull, down, shape_.support_map.find_start(down));
  return normal_.dot(state.position) - down.dot(shape_.hull.vertices[vertex]);
}

// Where samples are farther apart than what is kept, the last one holds; where they are closer, the first
// counts.
void DropObserver::keep_energy(double time_s, float energy) {
  const double interval = kObservationStep * std::sqrt(scale_);
  const auto index = std::min<std::size_t>(std::lround(time_s / interval), kKineticEnergySamples);
  if (kinetic_energy_.size() < index)
    kinetic_energy_.resize(index, kinetic_energy_.empty() ? energy : kinetic_energy_.back());
  if (kinetic_energy_.size() == index && index < kKineticEnergySamples) kinetic_energy_.push_back(energy);
}

bool DropObserver::settled() const {
  return last_time_ - last_stir_time_ >= kSettledDuration * std::sqrt(scale_);
}

double DropObserver::horizon_s() const { return kHorizon * std::sqrt(scale_); }

DropObservation DropObserver::result() const {
  check_that(samples_ > 0, "a drop was sampled");
  const Vec3 way = last_.position - start_.position;
  DropObservation drop;
  drop.bounces = bounces_;
  drop.rest_time_s = rest_time_;
  drop.distance_m = (way - normal_.dot(way) * normal_).norm();
  drop.first_rebound_m = rebound_;
  drop.first_impact = first_impact_;
  drop.at_rest = last_time_ - rest_time_ >= kRestDuration * std::sqrt(scale_);
  drop.after_a_second = after_a_second_;
  drop.up_in_body = last_.orientation.conjugate() * normal_;
  drop.kinetic_energy = kinetic_energy_;
  drop.kinetic_energy.resize(kKineticEnergySamples, kinetic_energy_.back());
  return drop;
}

}  // namespace lodestone
