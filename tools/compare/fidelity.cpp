#include "tools/compare/fidelity.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "reference/error.h"
#include "reference/random.h"
#include "tools/compare/rest_classes.h"
#include "tools/compare/wasserstein.h"

namespace lodestone {
namespace {

constexpr double kLeastResting = 0.1;  // fraction of the truth's drops below which rest means nothing

using Drops = std::span<const DropObservation>;
using Counts = std::vector<std::uint32_t>;  // how often each drop counts in a resample

template <typename Quantity>
std::vector<double> values_of(Drops drops, Quantity quantity) {
  std::vector<double> values;
  values.reserve(drops.size());
  for (const DropObservation& drop : drops) values.push_back(double(quantity(drop)));
  return values;
}

double weighted_mean_of(const std::vector<double>& values, const Counts& counts) {
  return std::inner_product(values.begin(), values.end(), counts.begin(), 0.0) /
         std::accumulate(counts.begin(), counts.end(), 0.0);
}

double deviation_of(const std::vector<double>& values, const Counts& counts) {
  const double mean = weighted_mean_of(values, counts);
  double sum = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) sum += counts[i] * (values[i] - mean) * (values[i] - mean);
  return std::sqrt(sum / std::accumulate(counts.begin(), counts.end(), 0.0));
}

// One number of each drop.
class ScalarPart {
 public:
  template <typename Quantity>
  ScalarPart(Drops truth, Drops method, Quantity quantity)
      : truth_(values_of(truth, quantity)), pair_(truth_, values_of(method, quantity)) {}

  // None where the truth does not vary.
  std::optional<double> distance(const Counts& truth, const Counts& method) const {
    const double deviation = deviation_of(truth_, truth);
    if (deviation <= 1e-9 * std::abs(weighted_mean_of(truth_, truth))) return std::nullopt;
    return pair_.wasserstein(truth, method) / deviation;
  }

 private:
  std::vector<double> truth_;
  SamplePair pair_;
};

// Kinetic energy over time.
class EnergyPart {
 public:
  EnergyPart(Drops truth, Drops method) {
    for (int t = 0; t < kKineticEnergySamples; ++t) {
      const auto at_t = [t](const DropObservation& drop) { return drop.kinetic_energy[t]; };
      truth_.push_back(values_of(truth, at_t));
      pairs_.emplace_back(truth_.back(), values_of(method, at_t));
    }
  }

  std::optional<double> distance(const Counts& truth, const Counts& method) const {
    double distance = 0.0, energy = 0.0;
    for (int t = 0; t < kKineticEnergySamples; ++t) {
      distance += pairs_[t].wasserstein(truth, method);
      energy += weighted_mean_of(truth_[t], truth);
    }
    if (energy <= 0.0) return std::nullopt;
    return distance / energy;
  }

 private:
  std::vector<std::vector<double>> truth_;
  std::vector<SamplePair> pairs_;
};

// How often each rest pose is the end.
class RestPosePart {
 public:
  RestPosePart(Drops truth, Drops method) {
    std::vector<Vec3> ups;
    for (const DropObservation& drop : truth)
      if (drop.at_rest) ups.push_back(drop.up_in_body);
    const RestClasses classes = make_rest_classes(ups);
    none_ = int(classes.size());
    truth_ = classify(truth, classes);
    method_ = classify(method, classes);
  }

  std::optional<double> distance(const Counts& truth, const Counts& method) const {
    const std::vector<double> p = frequencies(truth_, truth), q = frequencies(method_, method);
    double sum = 0.0;
    for (std::size_t i = 0; i < p.size(); ++i) sum += std::abs(p[i] - q[i]);
    return 0.5 * sum;
  }

 private:
  std::vector<int> classify(Drops drops, const RestClasses& classes) const {
    std::vector<int> found;
    for (const DropObservation& drop : drops)
      found.push_back(drop.at_rest ? find_rest_class(classes, drop.up_in_body).value_or(none_) : none_);
    return found;
  }

  std::vector<double> frequencies(const std::vector<int>& classes, const Counts& counts) const {
    std::vector<double> frequency(none_ + 1, 0.0);
    const double all = std::accumulate(counts.begin(), counts.end(), 0.0);
    for (std::size_t i = 0; i < classes.size(); ++i) frequency[classes[i]] += counts[i] / all;
    return frequency;
  }

  int none_ = 0;
  std::vector<int> truth_, method_;
};

// Truth and a method, prepared so that a resample is scored quickly.
class Scoring {
 public:
  Scoring(Drops truth, Drops method)
      : bounces_(truth, method, [](const DropObservation& drop) { return drop.bounces; }),
        rest_time_(truth, method, [](const DropObservation& drop) { return drop.rest_time_s; }),
        distance_(truth, method, [](const DropObservation& drop) { return drop.distance_m; }),
        peak_(truth, method, [](const DropObservation& drop) { return drop.first_rebound_m; }),
        energy_(truth, method),
        rest_pose_(truth, method),
        truth_rests_(double(std::ranges::count_if(truth, &DropObservation::at_rest)) >=
                     kLeastResting * double(truth.size())) {}

  DropScore score(const Counts& truth, const Counts& method) const {
    DropScore score;
    score.w_bounces = bounces_.distance(truth, method);
    score.w_distance = distance_.distance(truth, method);
    score.w_peak = peak_.distance(truth, method);
    score.ke_w = energy_.distance(truth, method);
    if (truth_rests_) {
      score.w_rest_time = rest_time_.distance(truth, method);
      score.tv = rest_pose_.distance(truth, method);
    }
    average(score);
    return score;
  }

 private:
  static void average(DropScore& score) {
    double sum = 0.0;
    for (const auto& part :
         {score.w_bounces, score.w_rest_time, score.w_distance, score.w_peak, score.ke_w, score.tv})
      if (part) sum += *part, ++score.parts;
    if (score.parts > 0) score.score = sum / score.parts;
  }

  ScalarPart bounces_, rest_time_, distance_, peak_;
  EnergyPart energy_;
  RestPosePart rest_pose_;
  bool truth_rests_;
};

// As many drops as there are, each drawn from all of them.
Counts resample(std::size_t drops, RandomStream random) {
  Counts counts(drops, 0);
  for (std::size_t i = 0; i < drops; ++i) ++counts[std::size_t(random.uniform() * double(drops))];
  return counts;
}

std::array<double, 2> interval_of(std::vector<double> resampled, double score) {
  std::ranges::sort(resampled);
  const double last = double(resampled.size() - 1);
  const double shift =
      score - std::accumulate(resampled.begin(), resampled.end(), 0.0) / double(resampled.size());
  const double low = resampled[std::size_t(std::lround(0.025 * last))];
  const double high = resampled[std::size_t(std::lround(0.975 * last))];
  return {std::max(0.0, low + shift), high + shift};
}

}  // namespace

ScoreWithInterval score_drops(std::span<const DropObservation> truth, std::span<const DropObservation> method,
                              std::uint64_t seed, int bootstrap_samples) {
  check_that(!truth.empty() && !method.empty() && bootstrap_samples > 0,
             "there are drops and resamples to score");
  const Scoring scoring(truth, method);
  ScoreWithInterval result;
  result.value = scoring.score(Counts(truth.size(), 1), Counts(method.size(), 1));
  std::vector<double> resampled;
  for (int i = 0; i < bootstrap_samples; ++i)
    resampled.push_back(scoring
                            .score(resample(truth.size(), {seed, std::uint64_t(i), 0}),
                                   resample(method.size(), {seed, std::uint64_t(i), 1}))
                            .score);
  result.interval = interval_of(std::move(resampled), result.value.score);
  return result;
}

}  // namespace lodestone
