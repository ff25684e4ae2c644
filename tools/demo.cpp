#include "tools/demo.h"

#include <fmt/format.h>

#include <algorithm>

#include "tools/drop_report.h"
#include "tools/text_table.h"

namespace lodestone {
namespace {

constexpr int kBusySteps = 8;  // a step of a thousand trimeshes takes seconds
constexpr int kUntimedSteps = 2;  // in which ODE's bodies are made

// Where the statistical level has the most contacts.
int find_busy_step(const RunResult& result) {
  const auto busiest = std::ranges::max_element(result.reports, {}, &StepReport::contacts);
  return std::clamp(int(busiest - result.reports.begin()), 0, std::max(0, result.steps - kBusySteps));
}

TimeSummary summarize_window(const RunResult& result, int first, int count) {
  std::vector<double> ms;
  for (int i = first; i < std::min(first + count, result.steps); ++i) ms.push_back(result.reports[i].times.total_ms);
  return summarize(ms);
}

DemoRow make_row(std::string name, const RunResult& result, int busy_step) {
  DemoRow row{.name = std::move(name), .whole_ms = result.step_ms, .busy_ms = summarize_window(result, busy_step, kBusySteps)};
  row.most_full = std::ranges::max_element(result.reports, {}, &StepReport::full)->full;
  return row;
}

// The scene as a statistical run leaves it after `steps` steps.
Scene scene_after(const Scene& scene, RunSettings settings, int steps) {
  settings.steps = steps;
  settings.level = LevelChoice::statistical;
  const RunResult result = run_scene(scene, settings);
  Scene later = scene;
  for (std::size_t i = 0; i < later.bodies.size(); ++i) later.bodies[i].definition.state = result.states[i];
  return later;
}

DemoRow run_full(const Scene& scene, RunSettings settings, int busy_step) {
  const Scene busy = busy_step > 0 ? scene_after(scene, settings, busy_step) : scene;
  settings.level = LevelChoice::full;
  settings.steps = kUntimedSteps + kBusySteps;
  const RunResult result = run_scene(busy, settings);
  return {.name = "full", .whole_ms = std::nullopt, .busy_ms = summarize_window(result, kUntimedSteps, kBusySteps), .most_full = result.bodies};
}

DropJob make_drop_job(const Scene& scene) {
  const BodyDefinition& body = scene.bodies.front().definition;
  DropJob job;
  job.shape = body.shape;
  job.material = scene.materials[body.material];
  return job;
}

std::string text_of_times(const DemoResult& result) {
  const auto number = [](double ms) { return fmt::format("{:.2f}", ms); };
  TextTable table({"level", "median ms", "99 % ms", "busy median ms", "most at full"});
  for (const DemoRow& row : result.rows)
    table.add_row({row.name, row.whole_ms ? number(row.whole_ms->p50) : "-", row.whole_ms ? number(row.whole_ms->p99) : "-",
                   number(row.busy_ms.p50), fmt::format("{}", row.most_full)});
  return table.text();
}

}  // namespace

DemoResult run_demo(const Scene& scene, const RunSettings& settings, int trials, const Progress& progress) {
  RunSettings quiet = settings;
  quiet.out.clear();
  DemoResult result;
  const auto run_with = [&](const std::string& name, RunSettings with) {
    with.progress = [&](int step, int steps) { if (progress) progress(name, double(step) / steps); };
    return run_scene(scene, with);
  };
  RunSettings statistical = quiet;
  statistical.level = LevelChoice::statistical;
  statistical.model = StatisticalModel::support;
  const RunResult support = run_with("statistical, support", statistical);
  result.busy_step = find_busy_step(support);
  result.busy_steps = kBusySteps;
  result.rows.push_back(make_row("statistical, support", support, result.busy_step));
  statistical.model = StatisticalModel::tables;
  result.rows.push_back(make_row("statistical, tables", run_with("statistical, tables", statistical), result.busy_step));
  result.mixed = run_with("mixed", settings);
  result.rows.push_back(make_row("mixed", result.mixed, result.busy_step));
  if (progress) progress("full, in the busy window", 0.0);
  result.rows.push_back(run_full(scene, quiet, result.busy_step));
  result.bodies = result.mixed.bodies;
  result.steps = result.mixed.steps;
  result.dt_s = settings.dt_s.value_or(scene.step.dt_s);
  result.drop = make_drop_job(scene);
  DropComparisonSettings comparison;
  comparison.trials = trials;
  comparison.dt_s = {result.dt_s};
  comparison.methods = {"full", "full_1", "statistical"};
  comparison.progress = progress;
  result.errors = compare_drops(result.drop, comparison);
  return result;
}

std::string text_of(const DemoResult& result) {
  std::string text;
  text += fmt::format("{} bodies, {} steps of {:.4g} ms\n\n", result.bodies, result.steps, 1e3 * result.dt_s);
  text += "What a step costs\n\n" + text_of_times(result);
  text += fmt::format("\nbusy: steps {} to {}, those of the most contacts; full is run over these alone\n\n", result.busy_step + 1,
                      result.busy_step + result.busy_steps);
  text += "What it costs in accuracy\n\n" + text_of(result.drop, result.errors);
  if (!result.mixed.trajectory.empty())
    text += fmt::format("\nThe mixed run is in {}, for any viewer of glTF\n", result.mixed.trajectory.string());
  return text;
}

}  // namespace lodestone
