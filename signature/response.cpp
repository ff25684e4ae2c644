#include "signature/response.h"

#include <algorithm>
#include <numbers>
#include <span>

namespace lodestone {
namespace {

double center_of(std::int64_t i, int n, double range) { return (double(i) + 0.5) * range / n; }

std::int64_t part_of(double x, int n, double range) {
  return std::clamp(std::int64_t(x / range * n), std::int64_t(0), std::int64_t(n) - 1);
}

std::int64_t nearest(std::span<const float> rising, double x) {
  const auto distance = [x](float sample) { return std::abs(double(sample) - x); };
  return std::ranges::min_element(rising, {}, distance) - rising.begin();
}

}  // namespace

CollisionConfiguration ResponseTable::center(std::int64_t cell) const {
  const std::int64_t k = cell / n_psi % n_alpha, j = cell / n_psi / n_alpha % n_phi,
                     i = cell / n_psi / n_alpha / n_phi;
  const double alpha = center_of(k, n_alpha, std::numbers::pi / 2);
  return {.theta = center_of(i, n_theta, std::numbers::pi / 2),
          .phi = center_of(j, n_phi, std::numbers::pi),
          .psi = 2.0 * std::numbers::pi * double(cell % n_psi) / n_psi,
          .speed = std::cos(alpha),
          .spin = std::sin(alpha)};
}

std::int64_t ResponseTable::find_cell(const CollisionConfiguration& c) const {
  const std::int64_t i = part_of(c.theta, n_theta, std::numbers::pi / 2),
                     j = part_of(c.phi, n_phi, std::numbers::pi),
                     k = part_of(c.alpha(), n_alpha, std::numbers::pi / 2);
  const std::int64_t l = (std::llround(c.psi / (2.0 * std::numbers::pi) * n_psi) % n_psi + n_psi) % n_psi;
  return ((i * n_phi + j) * n_alpha + k) * n_psi + l;
}

CollisionConfiguration SpeedTable::center(std::int64_t cell) const {
  const auto n_spins = std::int64_t(spins.size()), n_speeds = std::int64_t(speeds.size());
  return {.theta = center_of(cell / n_spins / n_speeds / n_phi, n_theta, std::numbers::pi / 2),
          .phi = center_of(cell / n_spins / n_speeds % n_phi, n_phi, std::numbers::pi),
          .speed = speeds[std::size_t(cell / n_spins % n_speeds)],
          .spin = spins[std::size_t(cell % n_spins)]};
}

std::int64_t SpeedTable::find_cell(const CollisionConfiguration& c) const {
  const std::int64_t i = part_of(c.theta, n_theta, std::numbers::pi / 2),
                     j = part_of(c.phi, n_phi, std::numbers::pi);
  return ((i * n_phi + j) * std::int64_t(speeds.size()) + nearest(speeds, c.speed)) *
             std::int64_t(spins.size()) +
         nearest(spins, c.spin);
}

}  // namespace lodestone
