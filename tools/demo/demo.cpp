#include "tools/demo/demo.h"

#include <fmt/format.h>

#include <algorithm>

#include "tools/scene_signatures.h"

namespace lodestone {
namespace {

constexpr int kBusySteps = 8;     // at most: a step of a thousand trimeshes takes seconds
constexpr int kUntimedSteps = 2;  // in which ODE's bodies are made

TimeSummary summarize_window(const RunResult& result, const BusyWindow& busy) {
  std::vector<double> ms;
  for (int i = busy.first; i < std::min(busy.first + busy.steps, result.steps); ++i)
    ms.push_back(result.reports[std::size_t(i)].times.total_ms);
  return summarize(ms);
}

DemoRow make_row(std::string name, const RunResult& result, const BusyWindow& busy) {
  const int most_full = std::ranges::max_element(result.reports, {}, &StepReport::full)->full;
  return {.name = std::move(name),
          .whole_ms = result.step_ms,
          .processor_ms = result.processor_ms,
          .busy_ms = summarize_window(result, busy),
          .most_full = most_full};
}

class Demo {
 public:
  Demo(const Scene& scene, const RunSettings& settings, const Progress& progress)
      : scene_(scene), settings_(settings), progress_(progress) {}

  DemoResult run(int trials) {
    DemoResult result;
    fetch_signatures(scene_, settings_);
    result.dt_s = settings_.dt_s.value_or(scene_.step.dt_s);
    measure_times(result);
    result.drop = make_drop_job();
    result.errors = compare(result.drop, result.dt_s, trials);
    return result;
  }

 private:
  void measure_times(DemoResult& result) {
    const RunResult support = run_statistical(StatisticalModel::support);
    result.busy = find_busy_window(support.reports);
    result.rows.push_back(make_row("statistical, support", support, result.busy));
    result.rows.push_back(
        make_row("statistical, tables", run_statistical(StatisticalModel::tables), result.busy));
    result.mixed = run_scene(scene_, reporting(settings_, "mixed"));
    result.rows.push_back(make_row("mixed", result.mixed, result.busy));
    result.rows.push_back(run_full(result.busy));
  }

  RunSettings reporting(RunSettings settings, const std::string& name) const {
    settings.keep_steps = true;
    settings.progress = [this, name](const RunProgress& run) {
      if (progress_) progress_(fmt::format("{}, {}", name, text_of(run)), double(run.step) / run.steps);
    };
    return settings;
  }

  RunSettings at_level(LevelChoice level, const std::string& name) const {
    RunSettings settings = reporting(settings_, name);
    settings.out.clear();
    settings.level = level;
    return settings;
  }

  RunResult run_statistical(StatisticalModel model) const {
    RunSettings settings = at_level(LevelChoice::statistical, "statistical");
    settings.model = model;
    return run_scene(scene_, settings);
  }

  DemoRow run_full(const BusyWindow& busy) const {
    RunSettings settings = at_level(LevelChoice::full, "full");
    settings.steps = kUntimedSteps + busy.steps;
    const RunResult result = run_scene(scene_after(busy.first), settings);
    return {.name = "full",
            .whole_ms = std::nullopt,
            .processor_ms = std::nullopt,
            .busy_ms = summarize_window(result, {kUntimedSteps, busy.steps}),
            .most_full = result.bodies};
  }

  // The scene as a statistical run leaves it.
  Scene scene_after(int steps) const {
    Scene later = scene_;
    if (steps == 0) return later;
    RunSettings settings = at_level(LevelChoice::statistical, "statistical, up to the busy window");
    settings.steps = steps;
    const RunResult result = run_scene(scene_, settings);
    for (std::size_t i = 0; i < later.bodies.size(); ++i) later.bodies[i].definition.state = result.states[i];
    return later;
  }

  DropJob make_drop_job() const {
    const BodyDefinition& body = scene_.bodies.front().definition;
    DropJob job;
    job.shape = body.shape;
    job.material = scene_.materials[body.material];
    return job;
  }

  DropComparison compare(const DropJob& job, double dt_s, int trials) const {
    DropComparisonSettings settings;
    settings.trials = trials;
    settings.dt_s = {dt_s};
    settings.methods = {"full", "full_1", "statistical"};
    settings.progress = progress_;
    return compare_drops(job, settings);
  }

  const Scene& scene_;
  const RunSettings& settings_;
  const Progress& progress_;
};

}  // namespace

BusyWindow find_busy_window(std::span<const StepReport> reports) {
  const int all = int(reports.size()), steps = std::min(kBusySteps, all);
  const auto busiest = std::ranges::max_element(reports, {}, &StepReport::contacts);
  return {std::min(int(busiest - reports.begin()), all - steps), steps};
}

DemoResult run_demo(const Scene& scene, const RunSettings& settings, int trials, const Progress& progress) {
  if (scene.bodies.empty())
    throw_input_error(scene.file.string() + ": bodies", "none", "one or more to drop");
  return Demo(scene, settings, progress).run(trials);
}

std::vector<RunResult> run_budgets(const Scene& scene, RunSettings settings, const Progress& progress) {
  fetch_signatures(scene, settings);
  settings.out.clear();
  settings.budget_work.reset(), settings.full_within_m.reset();  // of the main scene's run, too
  std::vector<RunResult> budgets;
  for (const double ms : kDemoBudgets) {
    settings.budget_ms = ms;
    settings.keep_steps = true;
    settings.progress = [&](const RunProgress& run) {
      if (progress)
        progress(fmt::format("a budget of {:g} ms, {}", ms, text_of(run)), double(run.step) / run.steps);
    };
    budgets.push_back(run_scene(scene, settings));
  }
  return budgets;
}

}  // namespace lodestone
