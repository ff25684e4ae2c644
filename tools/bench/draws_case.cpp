// S6.
#include <fmt/format.h>

#include "reference/random.h"
#include "signature/response_lookup.h"
#include "tools/bench/response_cases.h"
#include "tools/bench/statistical_case_parts.h"

namespace lodestone {
namespace {

constexpr double kFarFromTheEdge = 6.0;  // deviations: farther from v·n = 0 than truncation reaches

struct Errors {
  double mean = 0.0;      ///< over the cell's deviation
  double variance = 0.0;  ///< relative
  int numbers = 0;        ///< that were compared
};

/// The numbers of a cell that truncation does not touch against draws from it.
void add_cell(const Signature& signature, std::int64_t cell, int draws, Errors& errors) {
  CollisionConfiguration c = signature.bouncing.center(cell);
  c.speed *= 100.0, c.spin *= 100.0;  // everything bounces
  const FoundResponse found = find_response(signature, c, 0.05);
  const double e = signature.settings.law.restitution, speed = c.speed / c.speed_unit();
  const Vec3 particle(e * speed * std::cos(c.theta), speed * std::sin(c.theta), 0.0);
  Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero(), squares = sum;
  for (int k = 0; k < draws; ++k) {
    RandomStream random(109, std::uint64_t(cell), std::uint32_t(k));
    const DrawnVelocities drawn = draw_response(found, c, e, signature.settings.draw, random);
    Eigen::Matrix<double, 6, 1> error;
    error << drawn.linear - particle, drawn.angular;
    error -= signature.bouncing.cells.mean[std::size_t(cell)].cast<double>();
    sum += error, squares += error.cwiseProduct(error);
  }
  for (int i = 0; i < 6; ++i) {
    const double mean = double(signature.bouncing.cells.mean[std::size_t(cell)][i]), deviation = double(signature.bouncing.cells.deviation[std::size_t(cell)][i]);
    if (deviation <= 0.0 || (i == 0 && particle.x() + mean < kFarFromTheEdge * deviation)) continue;
    errors.mean = worse(errors.mean, std::abs(sum[i] / draws) / deviation);
    errors.variance = worse(errors.variance, std::abs((squares[i] / draws - sum[i] * sum[i] / draws / draws) / (deviation * deviation) - 1.0));
    ++errors.numbers;
  }
}

}  // namespace

std::vector<HardCaseRow> measure_draws(const HardCaseSettings& settings) {
  const int cells = settings.quick ? 20 : 200, draws = 100'000;
  const auto signature = find_case_signature(*box_of({0.2, 0.3, 0.4}));
  Errors errors;
  for (int i = 0; i < cells; ++i) add_cell(*signature, signature->bouncing.size() * i / cells, draws, errors);
  const std::string what = fmt::format("{:.0e} draws in {} cells: ", double(draws), cells);
  return {{.what = what + "greatest error of a mean over its deviation", .value = errors.mean, .bound = 4.5 / std::sqrt(double(draws))},
          {.what = what + "greatest relative error of a variance", .value = errors.variance, .bound = 0.03},
          {.what = what + "numbers compared", .value = double(errors.numbers), .bound = 4.0 * cells, .side = BoundSide::at_least}};
}

}  // namespace lodestone
