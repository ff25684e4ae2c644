#include "tools/scores/score_series.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "scenes/shape_source.h"
#include "tools/compare/drop_series.h"
#include "tools/compare/unseen_shapes.h"
#include "tools/interrupt.h"

namespace lodestone {
namespace {

constexpr const char *kBox = "box:0.2,0.3,0.4", *kL = "l:0.3,0.2,0.08,0.1", *kBunny = "bunny";
constexpr const char* kUsual = "usual";

/// Comparisons with the same settings.
struct ScoreJob {
  std::string shape;  ///< of all cases; empty: each case is named after its own
  std::vector<DropCase> cases;
  int trials = 300;
  std::vector<double> steps_s = {kObservationStep};
  std::vector<std::string> methods = {"statistical", "full_1"};
};

DropJob usual_job(const char* shape) {
  return {
      .shape = std::make_shared<const Shape>(make_shape_from_text(shape)), .conditions = {}, .material = {}};
}

ScoreJob usual_drops(const char* shape, int trials) {
  return {.shape = shape, .cases = {{kUsual, usual_job(shape)}}, .trials = trials};
}

std::vector<ScoreJob> make_quick() {
  std::vector<ScoreJob> jobs = {usual_drops(kBox, 100), usual_drops(kL, 100), usual_drops(kBunny, 40)};
  for (ScoreJob& job : jobs) job.methods = {"statistical"};
  return jobs;
}

std::vector<ScoreJob> make_drops() {
  std::vector<ScoreJob> jobs = {usual_drops(kBox, 600), usual_drops(kL, 600), usual_drops(kBunny, 300)};
  for (ScoreJob& job : jobs) job.steps_s = {0.0005, 0.004167, 0.008333, 0.016667};
  return jobs;
}

std::vector<ScoreJob> make_shapes() {
  ScoreJob job;
  for (const UnseenShape& shape : unseen_shapes())
    job.cases.push_back({std::string(shape.name),
                         {.shape = make_unseen_shape(shape.name), .conditions = {}, .material = {}}});
  return {job};
}

std::vector<ScoreJob> make_conditions_of_each() {
  std::vector<ScoreJob> jobs;
  for (const char* shape : {kBox, kL})
    jobs.push_back({.shape = shape, .cases = make_condition_cases(usual_job(shape))});
  // The truth of its thousands of faces on others takes hours.
  ScoreJob bunny{.shape = kBunny,
                 .cases = make_condition_cases(usual_job(kBunny)),
                 .trials = 200,
                 .methods = {"statistical"}};
  std::erase_if(bunny.cases, [](const DropCase& one) { return one.name.starts_with("ground="); });
  jobs.push_back(bunny);
  return jobs;
}

std::vector<ScoreJob> make_materials_of_each() {
  std::vector<ScoreJob> jobs;
  for (const char* shape : {kBox, kL})
    jobs.push_back({.shape = shape, .cases = make_material_cases(usual_job(shape))});
  return jobs;
}

struct Series {
  const char* name;
  std::vector<ScoreJob> (*make)();
};

constexpr std::array<Series, 5> kSeries = {{{"quick", make_quick},
                                            {"drops", make_drops},
                                            {"shapes", make_shapes},
                                            {"conditions", make_conditions_of_each},
                                            {"materials", make_materials_of_each}}};

// As it stands in a table.
double rounded(double step_s) { return std::round(1e6 * step_s) / 1e6; }

void add_rows(const std::string& series, const std::string& commit, const ScoreJob& job, const DropCase& one,
              const DropComparison& comparison, std::vector<ScoreRow>& rows) {
  const double floor = comparison.floor.value.score;
  for (const DropRow& row : comparison.rows) {
    if (!row.score) continue;
    const bool is_named_after_shape = job.shape.empty();
    rows.push_back(
        {{series, is_named_after_shape ? one.name : job.shape, is_named_after_shape ? kUsual : one.name,
          job.trials, row.model.empty() ? row.method : row.model, rounded(row.dt_s)},
         row.score->value.score,
         floor,
         bound_of(*row.score, floor),
         commit});
  }
}

}  // namespace

std::vector<std::string> score_series_names() {
  std::vector<std::string> names;
  for (const Series& series : kSeries) names.emplace_back(series.name);
  return names;
}

std::vector<ScoreRow> measure_scores(const std::string& series, const std::string& commit, int threads,
                                     const Progress& progress) {
  const auto known =
      std::ranges::find_if(kSeries, [&](const Series& candidate) { return series == candidate.name; });
  if (known == kSeries.end()) throw std::logic_error("no series " + series);
  std::vector<ScoreRow> rows;
  for (const ScoreJob& job : known->make()) {
    DropComparisonSettings settings;
    settings.trials = job.trials;
    settings.dt_s = job.steps_s;
    settings.methods = job.methods;
    settings.threads = threads;
    settings.costs = false;
    settings.progress = progress;
    const std::vector<DropComparison> comparisons = compare_series(job.cases, settings);
    throw_if_interrupted();
    for (std::size_t i = 0; i < comparisons.size(); ++i)
      add_rows(series, commit, job, job.cases[i], comparisons[i], rows);
  }
  return rows;
}

}  // namespace lodestone
