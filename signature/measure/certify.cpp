#include "signature/measure/certify.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "signature/response_lookup.h"

namespace lodestone {
namespace {

constexpr std::uint64_t kHeldOutDraws = 1ull
                                        << 43;  // key of the draws that held-out trials are compared with

void add_trials(std::span<const CellUnit> units, TableCertificate& c) {
  c.fewest_trials = ~0u;
  std::uint64_t into_plane_first = 0, into_plane = 0, impulses = 0;
  double mean_v = 0.0, deviation_v = 0.0, squares = 0.0, greatest_variance = 0.0;
  for (const CellUnit& unit : units) {
    c.trials += unit.trials, c.missed += unit.missed;
    c.fewest_trials = std::min(c.fewest_trials, unit.trials),
    c.most_trials = std::max(c.most_trials, unit.trials);
    into_plane_first += unit.into_plane_first, into_plane += unit.into_plane, impulses += unit.impulses;
    c.energy_ratio_first += unit.energy_ratio_first, c.energy_ratio += unit.energy_ratio;
    mean_v += unit.mean.head<3>().norm(), deviation_v += unit.deviation.head<3>().norm();
    const Response error = unit.deviation / std::sqrt(std::max(1.0f, float(unit.trials)));
    squares += error.squaredNorm() / 6.0;
    c.greatest_standard_error = std::max(c.greatest_standard_error, double(error.maxCoeff()));
    greatest_variance = std::max(greatest_variance, double(unit.deviation.cwiseAbs2().maxCoeff()));
  }
  const double trials = std::max(1.0, double(c.trials)), cells = std::max(1.0, double(units.size()));
  c.into_plane_first = double(into_plane_first) / trials, c.into_plane = double(into_plane) / trials,
  c.impulses = double(impulses) / trials;
  c.energy_ratio_first /= trials, c.energy_ratio /= trials;
  c.mean_over_deviation = deviation_v > 0.0 ? mean_v / deviation_v : 0.0;
  c.standard_error = std::sqrt(squares / cells);
  if (c.greatest_standard_error > 0.0)
    c.uniform_trials =
        cells * std::ceil(greatest_variance / (c.greatest_standard_error * c.greatest_standard_error));
}

// What of velocities after a collision is compared: normal speed, speed, spin, over s.
std::array<double, 3> measures_of(const DrawnVelocities& v) {
  return {v.linear.x(), v.linear.norm(), v.angular.norm()};
}

DrawnVelocities velocities_of(const Response& response, const CollisionConfiguration& c, double restitution) {
  const double speed = c.speed / c.speed_unit();
  const Vec3 particle(restitution * speed * std::cos(c.theta), speed * std::sin(c.theta), 0.0);
  return {particle + response.head<3>().cast<double>(), response.tail<3>().cast<double>()};
}

// Of one component of `mean`, without bias: the spread of n trials about it, less the part that is their own,
// from Σ_{i≠j} (x_i − m)·(x_j − m). May be negative.
double squared_error_of_mean(std::span<const Response> trials, const Response& mean) {
  Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
  double squares = 0.0;
  for (const Response& x : trials) {
    const Eigen::Matrix<double, 6, 1> difference = (x - mean).cast<double>();
    sum += difference, squares += difference.squaredNorm();
  }
  const auto n = double(trials.size());
  return (sum.squaredNorm() - squares) / (n * (n - 1.0)) / 6.0;
}

void add_held_out(std::span<const HeldOutUnit> units, TableKind kind, const Signature& signature,
                  TableCertificate& c) {
  HeldOutComparison compared = compare_held_out(units, kind, signature);
  c.held_out = compared.held_out[0].size();
  c.held_out_error = compared.error_of_mean;
  for (std::size_t k = 0; k < 3; ++k)
    c.held_out_ks = std::max(
        c.held_out_ks, kolmogorov_smirnov(std::move(compared.drawn[k]), std::move(compared.held_out[k])));
}

}  // namespace

TableCertificate certify_table(const TableUnits& units, TableKind kind, const Signature& signature) {
  TableCertificate certificate;
  add_trials(units.cells, certificate);
  add_held_out(units.held_out, kind, signature, certificate);
  return certificate;
}

HeldOutComparison compare_held_out(std::span<const HeldOutUnit> units, TableKind kind,
                                   const Signature& signature) {
  const double bounce_velocity = kind == TableKind::non_bouncing ? 1e300 : 0.0;
  const double restitution = kind == TableKind::non_bouncing ? 0.0 : signature.settings.law.restitution;
  HeldOutComparison compared;
  double squared_errors = 0.0;
  int conditions = 0;
  for (std::size_t i = 0; i < units.size(); ++i) {
    const HeldOutUnit& unit = units[i];
    if (unit.responses.size() < 2) continue;
    const FoundResponse found = find_response(signature, unit.configuration, bounce_velocity);
    squared_errors += squared_error_of_mean(unit.responses, found.mean);
    ++conditions;
    RandomStream random(signature.settings.seed, kHeldOutDraws | i, std::uint32_t(kind));
    for (const Response& response : unit.responses) {
      const auto truth = measures_of(velocities_of(response, unit.configuration, restitution));
      const auto draw =
          measures_of(draw_response(found, unit.configuration, restitution, signature.settings.draw, random));
      for (std::size_t k = 0; k < 3; ++k)
        compared.held_out[k].push_back(truth[k]), compared.drawn[k].push_back(draw[k]);
    }
  }
  compared.error_of_mean = conditions ? std::sqrt(std::max(0.0, squared_errors / conditions)) : 0.0;
  return compared;
}

double kolmogorov_smirnov(std::vector<double> a, std::vector<double> b) {
  if (a.empty() || b.empty()) return 0.0;
  std::ranges::sort(a);
  std::ranges::sort(b);
  double greatest = 0.0;
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    const double x = std::min(a[i], b[j]);
    while (i < a.size() && a[i] <= x) ++i;
    while (j < b.size() && b[j] <= x) ++j;
    greatest = std::max(greatest, std::abs(double(i) / double(a.size()) - double(j) / double(b.size())));
  }
  return greatest;
}

}  // namespace lodestone
