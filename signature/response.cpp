#include "signature/response.h"

#include <numbers>

namespace lodestone {
namespace {

constexpr double kPi = std::numbers::pi;

double center_of(std::int64_t i, int n, double range) { return (double(i) + 0.5) * range / n; }

}  // namespace

CollisionConfiguration ResponseTable::center(std::int64_t cell) const {
  const std::int64_t k = cell / n_psi % n_alpha, j = cell / n_psi / n_alpha % n_phi, i = cell / n_psi / n_alpha / n_phi;
  const double alpha = center_of(k, n_alpha, kPi / 2);
  return {.theta = center_of(i, n_theta, kPi / 2),
          .phi = center_of(j, n_phi, kPi),
          .psi = 2.0 * kPi * double(cell % n_psi) / n_psi,
          .speed = std::cos(alpha),
          .spin = std::sin(alpha)};
}

CollisionConfiguration SpeedTable::center(std::int64_t cell) const {
  const auto n_spins = std::int64_t(spins.size()), n_speeds = std::int64_t(speeds.size());
  return {.theta = center_of(cell / n_spins / n_speeds / n_phi, n_theta, kPi / 2),
          .phi = center_of(cell / n_spins / n_speeds % n_phi, n_phi, kPi),
          .speed = speeds[std::size_t(cell / n_spins % n_speeds)],
          .spin = spins[std::size_t(cell % n_spins)]};
}

}  // namespace lodestone
