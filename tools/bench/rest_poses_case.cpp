// S11.
#include <fmt/format.h>

#include <algorithm>

#include "reference/random.h"
#include "tools/bench/ensemble_cases.h"
#include "tools/bench/statistical_case_parts.h"
#include "tools/compare/drop_trials.h"
#include "tools/compare/rest_classes.h"

namespace lodestone {
namespace {

constexpr double kRarePose = 0.004;  // frequency above which a pose must not be missed

struct Subject {
  std::string what;
  std::shared_ptr<const Shape> shape;
  int truth_drops;
};

/// How many of `drops` end in each class; last, those that end in none.
std::vector<double> counts_of(std::span<const DropObservation> drops, const RestClasses& classes) {
  std::vector<double> counts(classes.size() + 1, 0.0);
  for (const DropObservation& drop : drops)
    ++counts[std::size_t(drop.at_rest ? find_rest_class(classes, drop.up_in_body).value_or(int(classes.size())) : int(classes.size()))];
  return counts;
}

double sum_of(const std::vector<double>& counts) {
  double sum = 0.0;
  for (const double count : counts) sum += count;
  return sum;
}

double total_variation(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(a[i] / sum_of(a) - b[i] / sum_of(b));
  return 0.5 * sum;
}

/// `n` draws from the frequencies of `counts`.
std::vector<double> draw_counts(const std::vector<double>& counts, int n, RandomStream random) {
  std::vector<double> drawn(counts.size(), 0.0);
  for (int k = 0; k < n; ++k) {
    double left = random.uniform() * sum_of(counts);
    std::size_t i = 0;
    while (i + 1 < counts.size() && (left -= counts[i]) >= 0.0) ++i;
    ++drawn[i];
  }
  return drawn;
}

/// The total variation that samples of these sizes have from each other although they are of the same frequencies.
double floor_of(const std::vector<double>& truth, int method_drops) {
  constexpr int kResamples = 40;
  double sum = 0.0;
  for (std::uint32_t i = 0; i < kResamples; ++i)
    sum += total_variation(draw_counts(truth, int(sum_of(truth)), {116, i, 0}), draw_counts(truth, method_drops, {116, i, 1}));
  return sum / kResamples;
}

/// That samples of the same frequencies differ as much (χ² of two samples, Wilson and Hilferty's approximation).
double chi_squared_p(const std::vector<double>& a, const std::vector<double>& b) {
  const double n = sum_of(a), m = sum_of(b);
  double chi = 0.0;
  int classes = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] + b[i] == 0.0) continue;
    const double d = std::sqrt(m / n) * a[i] - std::sqrt(n / m) * b[i];
    chi += d * d / (a[i] + b[i]), ++classes;
  }
  if (classes < 2) return 1.0;
  const double freedom = classes - 1, spread = 2.0 / (9.0 * freedom);
  return 0.5 * std::erfc((std::cbrt(chi / freedom) - 1.0 + spread) / std::sqrt(2.0 * spread));
}

RestClasses classes_of(std::span<const DropObservation> drops) {
  std::vector<Vec3> ups;
  for (const DropObservation& drop : drops)
    if (drop.at_rest) ups.push_back(drop.up_in_body);
  return make_rest_classes(ups);
}

void add_rows(std::vector<HardCaseRow>& rows, const Subject& subject, int method_drops) {
  const DropJob job{.shape = subject.shape, .conditions = {}, .material = {}};
  const auto signature = find_case_signature(*job.shape);
  const auto truth_drops = observe_drops(job, make_truth(job), {.trials = subject.truth_drops, .seed = 3});
  const RestClasses classes = classes_of(truth_drops);
  const std::vector<double> truth = counts_of(truth_drops, classes);
  const double floor = floor_of(truth, method_drops);
  for (const auto& [model, name] : kBothModels) {
    const DropMethod method{"statistical", StatisticalMethod{model, signature}, ""};
    const std::vector<double> found = counts_of(observe_drops(job, method, {.trials = method_drops, .seed = 4}), classes);
    int missing = 0;
    for (std::size_t i = 0; i < classes.size(); ++i) missing += truth[i] > kRarePose * sum_of(truth) && found[i] == 0.0;
    const std::string what = fmt::format("{} x {} dropped, {}: ", method_drops, subject.what, name);
    rows.push_back({.what = what + fmt::format("rest poses' total variation above the floor of {:.3f} (chi-squared p {:.2g})", floor, chi_squared_p(truth, found)),
                    .value = total_variation(truth, found) - floor, .bound = 0.04});
    rows.push_back({.what = what + "poses above .4 % missing", .value = double(missing), .bound = 0.0, .unit = "poses"});
  }
}

}  // namespace

std::vector<HardCaseRow> measure_rest_poses_of_drops(const HardCaseSettings& settings) {
  const bool quick = settings.quick;
  std::vector<Subject> subjects = {{"box", box_of({0.2, 0.3, 0.4}), quick ? 1000 : 3000}, {"plate", box_of({0.4, 0.3, 0.02}), quick ? 1000 : 3000}};
  if (!quick) {
    subjects.push_back({"L", share(make_shape("l", make_l(0.3, 0.2, 0.08, 0.1))), 3000});
    subjects.push_back({"bunny", share(make_bunny_shape(0.2)), 1000});
  }
  std::vector<HardCaseRow> rows;
  for (const Subject& subject : subjects) add_rows(rows, subject, quick ? 3000 : 10'000);
  return rows;
}

}  // namespace lodestone
