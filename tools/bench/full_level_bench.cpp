#include "tools/bench/full_level_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "reference/argument_error.h"
#include "tools/compare/drop_trials.h"
#include "tools/interrupt.h"
#include "tools/median.h"

namespace lodestone {
namespace {

constexpr double kStep = 1.0 / 60;
constexpr int kFallingSteps = 8;  // of drops from .3 m and more over a body's size of .2 m

struct StepTimes {
  std::vector<double> falling_ms, all_ms;
};

void time_steps(const DropJob& job, const Method& method, const FullLevelBenchSettings& settings,
                StepTimes& times) {
  MethodWorld world = make_many_drops(job, method, settings.seed, settings.bodies);
  for (int step = 0; step < settings.steps; ++step) {
    const auto start = std::chrono::steady_clock::now();
    world.step(kStep);
    const double ms =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    if (step > 0 && step < kFallingSteps)
      times.falling_ms.push_back(ms);  // the first one builds what later ones keep
    times.all_ms.push_back(ms);
  }
}

void check_is_ode(const Method& method) {
  if (!std::holds_alternative<OdeMethod>(method.way))
    throw ArgumentError(fmt::format("--methods: found '{}', expected methods of ODE", method.name));
}

}  // namespace

std::vector<FullLevelBenchRow> bench_full_level(const DropJob& job, const FullLevelBenchSettings& settings) {
  const auto methods = make_methods(settings.methods, job, {}, 1, settings.progress);
  std::ranges::for_each(methods, check_is_ode);
  std::vector<StepTimes> times(methods.size());
  until_interrupted([&] {
    for (int repeat = 0; repeat < settings.repeats; ++repeat)
      for (std::size_t i = 0; i < methods.size(); ++i) {
        if (settings.progress)
          settings.progress(methods[i].name,
                            (repeat + double(i) / double(methods.size())) / settings.repeats);
        if (methods[i].left_out.empty()) time_steps(job, methods[i], settings, times[i]);
      }
  });
  std::vector<FullLevelBenchRow> rows;
  for (std::size_t i = 0; i < methods.size(); ++i) {
    FullLevelBenchRow row{
        .method = methods[i].name, .substeps = methods[i].substeps(), .left_out = methods[i].left_out};
    if (row.left_out.empty() && times[i].falling_ms.empty()) row.left_out = "interrupted";
    if (row.left_out.empty()) {
      row.falling_ms = median_of(times[i].falling_ms);
      row.step_ms = median_of(times[i].all_ms);
      row.times_less = rows.empty() ? 1.0 : rows.front().step_ms / row.step_ms;
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace lodestone
