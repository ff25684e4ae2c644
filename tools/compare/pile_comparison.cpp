#include "tools/compare/pile_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reference/error.h"
#include "tools/interrupt.h"

namespace lodestone {
namespace {

constexpr int kTruthIterations = 40;      // of QuickStep
constexpr int kTruthDirectContacts = 10;  // contacts of one island above which QuickStep takes over

std::uint64_t seed_of_truth_a(std::uint64_t seed) { return 2 * seed; }
std::uint64_t seed_of_truth_b(std::uint64_t seed) { return 2 * seed + 1; }

// What hangs together by many contacts is too much for dWorldStep under any method.
void solve_large_piles_quickly(DropMethod& method) {
  auto* way = std::get_if<OdeMethod>(&method.way);
  if (!way) return;
  const OdeSettings full = ode_settings_of({});
  way->settings.direct_contacts_max = std::min(way->settings.direct_contacts_max, full.direct_contacts_max);
  way->settings.quick_step_iterations =
      std::max(way->settings.quick_step_iterations, full.quick_step_iterations);
}

template <typename Value>
double mean_of(std::span<const PileObservation> piles, Value value) {
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

class Comparison {
 public:
  Comparison(const DropJob& job, const PileComparisonSettings& settings)
      : job_(job), settings_(settings), overlap_(*job.shape, make_bin(settings.conditions.side).planes) {
    check_that(settings.piles >= 1, "there are piles to compare", fmt::format("piles {}", settings.piles));
    check_pile(*job.shape, settings.conditions);
  }

  PileComparison run() {
    // Methods first: an unknown name or an unwritable cache is found before the truth's minutes are spent.
    auto methods = make_drop_methods(settings_.methods, job_, settings_.measuring, settings_.threads,
                                     settings_.progress);
    std::ranges::for_each(methods, solve_large_piles_quickly);
    PileComparison result = compare_truth();
    until_interrupted([&] {
      for (const DropMethod& method : methods)
        for (const double dt_s : settings_.dt_s) result.rows.push_back(compare(method, dt_s, result.truth_a));
      for (std::size_t i = 0; i < result.rows.size(); ++i)  // in a pass of its own, with nothing else running
        measure_cost(methods[i / settings_.dt_s.size()], result.rows[i]);
    });
    return result;
  }

 private:
  PileComparison compare_truth() {
    const DropMethod truth = make_pile_truth(job_);
    PileComparison result{
        .shape = job_.shape->name, .conditions = settings_.conditions, .pile_count = settings_.piles};
    result.truth_substeps = truth.substeps();
    result.truth_iterations = std::get<OdeMethod>(truth.way).settings.quick_step_iterations;
    result.truth_a = observe(truth, seed_of_truth_a(settings_.seed), 1.0 / 60.0, "truth");
    result.truth_b = observe(truth, seed_of_truth_b(settings_.seed), 1.0 / 60.0, "truth, second batch");
    result.truth = compare_with_truth(result.truth_a, result.truth_a, *job_.shape);
    result.floor = compare_with_truth(result.truth_a, result.truth_b, *job_.shape);
    return result;
  }

  PileRow compare(const DropMethod& method, double dt_s, const std::vector<PileObservation>& truth) {
    PileRow row{.method = method.name,
                .model = method.model(),
                .dt_s = dt_s,
                .substeps = method.substeps(),
                .reason = method.left_out};
    if (!row.reason.empty()) return row;
    const std::string stage = fmt::format("{} {} at {:.4g} s", row.method, row.model, dt_s);
    row.piles = observe(method, seed_of_truth_b(settings_.seed), dt_s, stage);
    row.figures = compare_with_truth(truth, row.piles, *job_.shape);
    report(stage + ", momentum", 0.0);
    row.momentum_residual =
        measure_momentum_residual(job_, method, batch(seed_of_truth_b(settings_.seed), dt_s));
    return row;
  }

  void measure_cost(const DropMethod& method, PileRow& row) {
    if (!row.figures) return;
    report("timing", 0.0);
    row.ns_per_body_step = measure_ns_per_body_step(
        job_, method, batch(seed_of_truth_b(settings_.seed), row.dt_s), row.figures->sleep_time_s);
  }

  std::vector<PileObservation> observe(const DropMethod& method, std::uint64_t seed, double dt_s,
                                       const std::string& stage) {
    report(stage, 0.0);
    return observe_piles(job_, method, overlap_, batch(seed, dt_s),
                         [&](double fraction) { report(stage, fraction); });
  }

  PileBatch batch(std::uint64_t seed, double dt_s) const {
    return {.conditions = settings_.conditions,
            .piles = settings_.piles,
            .seed = seed,
            .dt_s = dt_s,
            .threads = settings_.threads};
  }

  void report(const std::string& stage, double fraction) const {
    if (settings_.progress) settings_.progress(stage, fraction);
  }

  const DropJob& job_;
  const PileComparisonSettings& settings_;
  PileOverlap overlap_;
};

}  // namespace

DropMethod make_pile_truth(const DropJob& job) {
  DropMethod truth = make_truth(job);
  OdeSettings& settings = std::get<OdeMethod>(truth.way).settings;
  settings.quick_step_iterations = kTruthIterations;
  settings.direct_contacts_max = kTruthDirectContacts;
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
  figures.sleep_time_s = mean_of(piles, sleep_time);
  figures.sleep_time_error = relative_error(figures.sleep_time_s, mean_of(truth, sleep_time));
  figures.mean_height_m = mean_of(piles, height);
  figures.mean_height_error = relative_error(figures.mean_height_m, mean_of(truth, height));
  for (const PileObservation& pile : piles) {
    figures.max_penetration_m = std::max(figures.max_penetration_m, pile.max_penetration_m);
    figures.energy_rise = std::max(figures.energy_rise, pile.energy_rise);
    figures.hovering += pile.hovering;
    figures.escaped += pile.escaped;
  }
  figures.penetration_over_size = figures.max_penetration_m / shape.size;
  return figures;
}

PileComparison compare_piles(const DropJob& job, const PileComparisonSettings& settings) {
  return Comparison(job, settings).run();
}

}  // namespace lodestone
