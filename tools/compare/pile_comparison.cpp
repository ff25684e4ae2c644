#include "tools/compare/pile_comparison.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "reference/argument_error.h"
#include "reference/error.h"

namespace lodestone {
namespace {

constexpr int kTruthIterations = 40;      // of QuickStep
constexpr int kTruthDirectContacts = 10;  // contacts of one island above which QuickStep takes over

struct FinerTruth {
  std::string_view name;
  void (*refine)(OdeMethod&);
};
constexpr std::array<FinerTruth, 3> kFinerTruths = {{
    {"half_step", [](OdeMethod& truth) { truth.substeps *= 2; }},
    {"iterations", [](OdeMethod& truth) { truth.settings.quick_step_iterations *= 4; }},
    {"direct",
     [](OdeMethod& truth) { truth.settings.direct_contacts_max = OdeSettings{}.direct_contacts_max; }},
}};

// What hangs together by many contacts is too much for dWorldStep under any method.
void solve_large_piles_quickly(Method& method) {
  auto* way = std::get_if<OdeMethod>(&method.way);
  if (!way) return;
  const OdeSettings full = ode_settings_of({});
  way->settings.direct_contacts_max = std::min(way->settings.direct_contacts_max, full.direct_contacts_max);
  way->settings.quick_step_iterations =
      std::max(way->settings.quick_step_iterations, full.quick_step_iterations);
}

template <typename Value>
double mean_over(std::span<const PileObservation> piles, Value value) {
  double sum = 0.0;
  for (const PileObservation& pile : piles) sum += value(pile) / double(piles.size());
  return sum;
}

std::vector<double> mean_energy_of(std::span<const PileObservation> piles) {
  std::vector<double> mean;
  for (const PileObservation& pile : piles) {
    mean.resize(std::max(mean.size(), pile.kinetic_energy.size()));
    for (std::size_t i = 0; i < mean.size(); ++i)
      mean[i] += (i < pile.kinetic_energy.size() ? pile.kinetic_energy[i] : pile.kinetic_energy.back()) /
                 double(piles.size());
  }
  return mean;
}

double relative_error(double value, double truth) { return truth != 0.0 ? value / truth - 1.0 : 0.0; }

class PileComparing {
 public:
  PileComparing(const DropJob& job, const PileComparisonSettings& settings)
      : job_(job), settings_(settings), overlap_(*job.shape, make_bin(settings.conditions.side)) {
    check_that(settings.piles >= 1, "there are piles to compare", fmt::format("piles {}", settings.piles));
    check_pile(*job.shape, settings.conditions);
  }

  PileComparison run() {
    // Methods first: an unknown name or an unwritable cache is found before the truth's minutes are spent.
    auto methods =
        make_methods(settings_.methods, job_, settings_.measuring, settings_.threads, settings_.progress);
    std::ranges::for_each(methods, solve_large_piles_quickly);
    std::vector<Method> finer;
    for (const std::string& name : settings_.check_truth) finer.push_back(make_finer_truth(job_, name));
    PileComparison result = compare_truth();
    result.rows = compare_methods<PileRow>(
        finer, as_the_truth_steps(),
        [&](const Method& method, PileRow& row) { compare(method, result.truth_a, row); },
        [](const Method&, PileRow&) {});
    const std::vector<PileRow> rows = compare_methods<PileRow>(
        methods, settings_, [&](const Method& method, PileRow& row) { compare(method, result.truth_a, row); },
        [&](const Method& method, PileRow& row) {
          row.ns_per_body_step = measure_ns_per_body_step(
              job_, method, batch(settings_.seed_of_truth_b(), row.dt_s), row.figures->sleep_time_s);
        });
    result.rows.insert(result.rows.end(), rows.begin(), rows.end());
    return result;
  }

 private:
  // Its substeps are those of a step between two observations, and its cost is no method's.
  ComparisonSettings as_the_truth_steps() const {
    ComparisonSettings settings = settings_;
    settings.dt_s = {kObservationStep};
    settings.costs = false;
    return settings;
  }

  PileComparison compare_truth() {
    const Method truth = make_pile_truth(job_);
    PileComparison result{
        .shape = job_.shape->name, .conditions = settings_.conditions, .pile_count = settings_.piles};
    result.truth_substeps = truth.substeps();
    result.truth_iterations = std::get<OdeMethod>(truth.way).settings.quick_step_iterations;
    result.truth_a = observe(truth, settings_.seed_of_truth_a(), kObservationStep, "truth");
    result.truth_b = observe(truth, settings_.seed_of_truth_b(), kObservationStep, "truth, second batch");
    result.truth = compare_with_truth(result.truth_a, result.truth_a, *job_.shape);
    result.floor = compare_with_truth(result.truth_a, result.truth_b, *job_.shape);
    return result;
  }

  void compare(const Method& method, const std::vector<PileObservation>& truth, PileRow& row) {
    const std::string stage = name_of(row);
    row.piles = observe(method, settings_.seed_of_truth_b(), row.dt_s, stage);
    row.figures = compare_with_truth(truth, row.piles, *job_.shape);
    settings_.report(stage + ", momentum", 0.0);
    row.momentum_residual =
        measure_momentum_residual(job_, method, batch(settings_.seed_of_truth_b(), row.dt_s));
  }

  std::vector<PileObservation> observe(const Method& method, std::uint64_t seed, double dt_s,
                                       const std::string& stage) {
    settings_.report(stage, 0.0);
    return observe_piles(job_, method, overlap_, batch(seed, dt_s),
                         [&](double fraction) { settings_.report(stage, fraction); });
  }

  PileBatch batch(std::uint64_t seed, double dt_s) const {
    return {.conditions = settings_.conditions,
            .piles = settings_.piles,
            .seed = seed,
            .dt_s = dt_s,
            .threads = settings_.threads};
  }

  const DropJob& job_;
  const PileComparisonSettings& settings_;
  PileOverlap overlap_;
};

}  // namespace

Method make_pile_truth(const DropJob& job) {
  Method truth = make_truth(job);
  OdeSettings& settings = std::get<OdeMethod>(truth.way).settings;
  settings.quick_step_iterations = kTruthIterations;
  settings.direct_contacts_max = kTruthDirectContacts;
  return truth;
}

std::vector<std::string> finer_truth_names() {
  std::vector<std::string> names;
  for (const FinerTruth& finer : kFinerTruths) names.emplace_back(finer.name);
  return names;
}

Method make_finer_truth(const DropJob& job, const std::string& name) {
  const auto finer = std::ranges::find(kFinerTruths, name, &FinerTruth::name);
  if (finer == kFinerTruths.end())
    throw ArgumentError(fmt::format("--check-truth: found '{}', expected some of {}", name,
                                    fmt::join(finer_truth_names(), ", ")));
  Method truth = make_pile_truth(job);
  finer->refine(std::get<OdeMethod>(truth.way));
  truth.name = "truth_" + name;
  return truth;
}

PileFigures compare_with_truth(std::span<const PileObservation> truth, std::span<const PileObservation> piles,
                               const Shape& shape) {
  check_that(!truth.empty() && !piles.empty(), "there are piles to compare");
  PileFigures figures;
  const std::vector<double> energy = mean_energy_of(piles), true_energy = mean_energy_of(truth);
  double difference = 0.0, sum = 0.0;
  for (std::size_t i = 0; i < true_energy.size(); ++i) {
    difference += std::abs(energy[std::min(i, energy.size() - 1)] - true_energy[i]);
    sum += true_energy[i];
  }
  figures.ke_l1 = sum > 0.0 ? difference / sum : 0.0;
  const auto sleep_time = [](const PileObservation& pile) { return pile.sleep_time_s; };
  const auto height = [](const PileObservation& pile) { return pile.mean_height_m; };
  figures.sleep_time_s = mean_over(piles, sleep_time);
  figures.sleep_time_error = relative_error(figures.sleep_time_s, mean_over(truth, sleep_time));
  figures.mean_height_m = mean_over(piles, height);
  figures.mean_height_error = relative_error(figures.mean_height_m, mean_over(truth, height));
  for (const PileObservation& pile : piles) {
    figures.max_penetration_m = std::max(figures.max_penetration_m, pile.max_penetration_m);
    figures.end_penetration_over_size =
        std::max(figures.end_penetration_over_size, pile.end_penetration_m / shape.size);
    figures.energy_rise = std::max(figures.energy_rise, pile.energy_rise);
    figures.hovering += pile.hovering;
    figures.escaped += pile.escaped;
  }
  figures.penetration_over_size = figures.max_penetration_m / shape.size;
  figures.median_penetration_over_size =
      mean_over(piles, [](const PileObservation& pile) { return pile.median_penetration_m; }) / shape.size;
  return figures;
}

PileComparison compare_piles(const DropJob& job, const PileComparisonSettings& settings) {
  return PileComparing(job, settings).run();
}

}  // namespace lodestone
