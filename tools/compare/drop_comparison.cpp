#include "tools/compare/drop_comparison.h"

#include <fmt/format.h>

#include "reference/error.h"
#include "tools/interrupt.h"

namespace lodestone {
namespace {

// Starts of the two batches, and of the bootstrap, must not coincide whatever the user's seed.
std::uint64_t seed_of_truth_a(std::uint64_t seed) { return 2 * seed; }
std::uint64_t seed_of_truth_b(std::uint64_t seed) { return 2 * seed + 1; }

class Comparison {
 public:
  Comparison(const DropJob& job, const DropComparisonSettings& settings) : job_(job), settings_(settings) {
    check_that(settings.trials >= 2, "there are drops to compare", fmt::format("trials {}", settings.trials));
  }

  DropComparison run() {
    // Methods first: an unknown name or an unwritable cache is found before the truth's minutes are spent.
    const auto methods = make_drop_methods(settings_.methods, job_, settings_.measuring, settings_.threads,
                                           settings_.progress);
    DropComparison result = compare_truth();
    until_interrupted([&] {
      for (const DropMethod& method : methods)
        for (const double dt_s : settings_.dt_s) result.rows.push_back(compare(method, dt_s, result));
      for (std::size_t i = 0; settings_.costs && i < result.rows.size();
           ++i)  // in a pass of its own, with nothing else running
        measure_cost(methods[i / settings_.dt_s.size()], result.rows[i]);
    });
    return result;
  }

 private:
  DropComparison compare_truth() {
    const DropMethod truth = make_truth(job_);
    DropComparison result{.shape = job_.shape->name, .trials = settings_.trials};
    result.truth_substeps = truth.substeps();
    result.truth_a = observe(truth, seed_of_truth_a(settings_.seed), kObservationStep, "truth");
    result.truth_b = observe(truth, seed_of_truth_b(settings_.seed), kObservationStep, "truth, second batch");
    result.floor = score_drops(result.truth_a, result.truth_b, settings_.seed);
    return result;
  }

  DropRow compare(const DropMethod& method, double dt_s, const DropComparison& truth) {
    DropRow row{.method = method.name,
                .model = method.model(),
                .dt_s = dt_s,
                .substeps = method.substeps(),
                .reason = method.left_out};
    if (!row.reason.empty()) return row;
    row.drops = observe(method, seed_of_truth_b(settings_.seed), dt_s,
                        fmt::format("{} {} at {:.4g} s", row.method, row.model, dt_s));
    row.score = score_drops(truth.truth_a, row.drops, settings_.seed);
    row.first_impacts = measure_impact_errors(truth.truth_b, row.drops);
    return row;
  }

  void measure_cost(const DropMethod& method, DropRow& row) {
    if (!row.reason.empty()) return;
    report("timing", 0.0);
    row.ns_per_body_step =
        measure_ns_per_body_step(job_, method, batch(seed_of_truth_b(settings_.seed), row.dt_s), row.drops);
  }

  std::vector<DropObservation> observe(const DropMethod& method, std::uint64_t seed, double dt_s,
                                       const std::string& stage) {
    return observe_drops(job_, method, batch(seed, dt_s), [&](double fraction) { report(stage, fraction); });
  }

  DropBatch batch(std::uint64_t seed, double dt_s) const {
    return {.trials = settings_.trials, .seed = seed, .dt_s = dt_s, .threads = settings_.threads};
  }

  void report(const std::string& stage, double fraction) const {
    if (settings_.progress) settings_.progress(stage, fraction);
  }

  const DropJob& job_;
  const DropComparisonSettings& settings_;
};

}  // namespace

std::int64_t DropRow::table_extrapolations() const {
  std::int64_t sum = 0;
  for (const DropObservation& drop : drops) sum += drop.table_extrapolations;
  return sum;
}

DropComparison compare_drops(const DropJob& job, const DropComparisonSettings& settings) {
  return Comparison(job, settings).run();
}

}  // namespace lodestone
