#include "tools/compare/drop_comparison.h"

#include <fmt/format.h>

#include "reference/error.h"

namespace lodestone {
namespace {

class DropComparing {
 public:
  DropComparing(const DropJob& job, const DropComparisonSettings& settings) : job_(job), settings_(settings) {
    check_that(settings.trials >= 2, "there are drops to compare", fmt::format("trials {}", settings.trials));
  }

  DropComparison run() {
    // Methods first: an unknown name or an unwritable cache is found before the truth's minutes are spent.
    const auto methods =
        make_methods(settings_.methods, job_, settings_.measuring, settings_.threads, settings_.progress);
    DropComparison result = compare_truth();
    result.rows = compare_methods<DropRow>(
        methods, settings_, [&](const Method& method, DropRow& row) { compare(method, result, row); },
        [&](const Method& method, DropRow& row) {
          row.ns_per_body_step =
              measure_ns_per_body_step(job_, method, batch(settings_.seed_of_truth_b(), row.dt_s), row.drops);
        });
    return result;
  }

 private:
  DropComparison compare_truth() {
    const Method truth = make_truth(job_, settings_.truth);
    DropComparison result{.shape = job_.shape->name, .trials = settings_.trials};
    result.truth_substeps = truth.substeps();
    result.truth_push_m_per_s = settings_.truth.push_m_per_s;
    result.truth_a = observe(truth, settings_.seed_of_truth_a(), kObservationStep, "truth");
    result.truth_b = observe(truth, settings_.seed_of_truth_b(), kObservationStep, "truth, second batch");
    result.floor = score_drops(result.truth_a, result.truth_b, settings_.seed);
    return result;
  }

  void compare(const Method& method, const DropComparison& truth, DropRow& row) {
    row.drops = observe(method, settings_.seed_of_truth_b(), row.dt_s, name_of(row));
    row.score = score_drops(truth.truth_a, row.drops, settings_.seed);
    row.first_impacts = measure_impact_errors(truth.truth_b, row.drops);
  }

  std::vector<DropObservation> observe(const Method& method, std::uint64_t seed, double dt_s,
                                       const std::string& stage) {
    return observe_drops(job_, method, batch(seed, dt_s),
                         [&](double fraction) { settings_.report(stage, fraction); });
  }

  DropBatch batch(std::uint64_t seed, double dt_s) const {
    return {.trials = settings_.trials, .seed = seed, .dt_s = dt_s, .threads = settings_.threads};
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
  return DropComparing(job, settings).run();
}

}  // namespace lodestone
