#include "signature/measure/cell_trials.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reference/random.h"

namespace lodestone {
namespace {

constexpr int kFirstBatch = 24;  // trials that an adaptive cell's first estimate is made of
// Keys of what is no cell.
constexpr std::uint64_t kHeldOutKey = 1ull << 41, kHeldOutConditionKey = 1ull << 42;

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

// Mean and covariance of a sample, one pass (Welford).
struct Moments {
  Vector6 mean = Vector6::Zero();
  Matrix6 products = Matrix6::Zero();
  int count = 0;
  void add(const Vector6& x) {
    ++count;
    const Vector6 before = x - mean;
    mean += before / count;
    products += before * (x - mean).transpose();
  }
  Matrix6 covariance() const {
    return count > 1 ? Matrix6(products / (count - 1)) : Matrix6(Matrix6::Zero());
  }
};

struct ApproachMoments {
  double sum = 0.0, squares = 0.0;
  Approach over(int count) const {
    if (count == 0) return {};
    const double mean = sum / count;
    return {float(mean), float(std::sqrt(std::max(0.0, squares / count - mean * mean)))};
  }
};

// Semidefinite at worst, so pivots that rounding made negative count as zero.
ResponseFactor factor_of(const Matrix6& covariance) {
  Matrix6 lower = Matrix6::Zero();
  for (int j = 0; j < 6; ++j) {
    const double pivot = covariance(j, j) - lower.row(j).squaredNorm();
    if (pivot <= 1e-12 * covariance(j, j)) continue;
    lower(j, j) = std::sqrt(pivot);
    for (int i = j + 1; i < 6; ++i)
      lower(i, j) = (covariance(i, j) - lower.row(i).dot(lower.row(j))) / lower(j, j);
  }
  ResponseFactor factor{};
  for (int row = 0, k = 0; row < 6; ++row)
    for (int column = 0; column <= row; ++column) factor[k++] = float(lower(row, column));
  return factor;
}

// How many trials a cell of this spread needs.
int trials_needed(const Moments& moments, const CellSampling& sampling) {
  const double variance = moments.covariance().diagonal().maxCoeff();
  const double needed = std::ceil(variance / (sampling.error * sampling.error));
  return int(std::min(needed, double(sampling.most_trials)));
}

void set_moments(const Moments& moments, CellUnit& unit) {
  unit.mean = moments.mean.cast<float>();
  const Matrix6 covariance = moments.covariance();
  unit.deviation = covariance.diagonal().cwiseMax(0.0).cwiseSqrt().cast<float>();
  unit.factor = factor_of(covariance);
  unit.trials = std::uint32_t(moments.count);
}

class CellMeasuring {
 public:
  CellMeasuring(CollisionTrial& trial, const CollisionConfiguration& center, std::int64_t cell,
                const CellSampling& sampling)
      : trial_(trial), center_(center), cell_(cell), sampling_(sampling) {}

  CellUnit measure() {
    if (sampling_.error <= 0.0) {
      run_until(sampling_.trials);
    } else {
      run_until(std::min(kFirstBatch, sampling_.most_trials));
      for (int needed; (needed = trials_needed(moments_, sampling_)) > next_;) run_until(needed);
    }
    set_moments(moments_, unit_);
    unit_.approach = approaches_.over(moments_.count);
    return std::move(unit_);
  }

 private:
  void run_until(int end) {
    for (; next_ < end; ++next_) {
      const CellTrial start = cell_trial(center_, cell_, std::uint32_t(next_), sampling_);
      if (const auto outcome = trial_.run(start.configuration, start.orientation))
        add(*outcome);
      else
        ++unit_.missed;
    }
  }

  void add(const CollisionOutcome& outcome) {
    moments_.add(outcome.end.response.cast<double>());
    approaches_.sum += outcome.approach;
    approaches_.squares += outcome.approach * outcome.approach;
    unit_.into_plane_first += outcome.first.moves_into_plane;
    unit_.into_plane += outcome.end.moves_into_plane;
    unit_.energy_ratio_first += outcome.first.energy_ratio;
    unit_.energy_ratio += outcome.end.energy_ratio;
    unit_.impulses += std::uint64_t(outcome.impulses);
    if (!sampling_.keep_responses) return;
    unit_.responses.push_back(outcome.end.response);
    unit_.approaches.push_back(float(outcome.approach));
  }

  CollisionTrial& trial_;
  const CollisionConfiguration& center_;
  std::int64_t cell_;
  const CellSampling& sampling_;
  int next_ = 0;
  Moments moments_;
  ApproachMoments approaches_;
  CellUnit unit_;
};

double between_logarithms(double low, double high, double part) { return low * std::pow(high / low, part); }

}  // namespace

CellTrial cell_trial(const CollisionConfiguration& center, std::int64_t cell, std::uint32_t k,
                     const CellSampling& sampling) {
  RandomStream random(sampling.seed, std::uint64_t(cell), k);
  CellTrial start{center, random.orientation()};
  if (sampling.every_psi) start.configuration.psi = random.uniform(0.0, 2.0 * std::numbers::pi);
  return start;
}

CellUnit make_cell_unit(std::span<const Response> responses) {
  Moments moments;
  for (const Response& response : responses) moments.add(response.cast<double>());
  CellUnit unit;
  set_moments(moments, unit);
  return unit;
}

CellUnit measure_cell(CollisionTrial& trial, const CollisionConfiguration& center, std::int64_t cell,
                      const CellSampling& sampling) {
  return CellMeasuring(trial, center, cell, sampling).measure();
}

HeldOutUnit measure_held_out(CollisionTrial& trial, const CollisionConfiguration& c, std::int64_t number,
                             std::uint64_t seed, bool every_psi) {
  HeldOutUnit unit{c, {}};
  for (std::uint32_t i = 0; i < kHeldOutTrials; ++i) {
    RandomStream random(seed, std::uint64_t(number) | kHeldOutKey, i);
    CollisionConfiguration start = c;
    const Quat orientation = random.orientation();
    if (every_psi) start.psi = random.uniform(0.0, 2.0 * std::numbers::pi);
    if (const auto outcome = trial.run(start, orientation)) unit.responses.push_back(outcome->end.response);
  }
  return unit;
}

CollisionConfiguration held_out_condition(std::int64_t number, std::uint64_t seed) {
  RandomStream random(seed, std::uint64_t(number) | kHeldOutConditionKey, 0);
  const double alpha = random.uniform(0.0, std::numbers::pi / 2);
  CollisionConfiguration c{.speed = std::cos(alpha), .spin = std::sin(alpha)};
  c.theta = random.uniform(0.0, std::numbers::pi / 2), c.phi = random.uniform(0.0, std::numbers::pi),
  c.psi = random.uniform(0.0, 2.0 * std::numbers::pi);
  return c;
}

CollisionConfiguration held_out_condition(const SpeedTable& table, std::int64_t number, std::uint64_t seed) {
  CollisionConfiguration c = held_out_condition(number, seed);
  RandomStream random(seed, std::uint64_t(number) | kHeldOutConditionKey, 1);
  c.speed = between_logarithms(table.speeds.front(), table.speeds.back(), random.uniform());
  c.spin = between_logarithms(table.spins[1], table.spins.back(), random.uniform());
  return c;
}

}  // namespace lodestone
