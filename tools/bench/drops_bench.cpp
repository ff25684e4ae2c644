#include "tools/bench/drops_bench.h"

#include <fmt/format.h>

#include <chrono>

#include "tools/compare/drop_trials.h"
#include "tools/compare/processor_time.h"
#include "tools/interrupt.h"

namespace lodestone {
namespace {

// The statistical level counts its sleepers by itself.
int count_awake(const MethodWorld& world) {
  const Manager* manager = world.manager();
  return manager ? world.bodies() - manager->report().asleep : world.awake();
}

class DropsBench {
 public:
  DropsBench(const DropJob& job, const DropsSettings& settings) : job_(job), settings_(settings) {}

  DropsRow measure(const Method& method) const {
    DropsRow row{.method = method.name, .model = method.model(), .left_out = method.left_out};
    if (!row.left_out.empty()) return row;
    const Method sleeping = with_sleep(method, true);
    MethodWorld world = make_many_drops(job_, sleeping, settings_.seed, settings_.bodies, settings_.threads);
    double ns = 0.0;
    int awake = settings_.bodies;
    for (int step = 0; step < kDropsSteps; ++step) {
      throw_if_interrupted();
      if (step % 20 == 0) show(row, step);
      row.awake_body_steps += awake;
      ns += measure_ns([&] { world.step(kDropsStep); });
      awake = count_awake(world);
    }
    row.seconds = 1e-9 * ns;
    row.awake = double(row.awake_body_steps) / kDropsSteps;
    row.ns_per_body_step = ns / double(row.awake_body_steps);
    return row;
  }

 private:
  /// Of this thread's processor; with others beside it, of the wall clock.
  template <typename Work>
  double measure_ns(Work work) const {
    if (settings_.threads == 1) return measure_processor_ns(work);
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count();
  }

  void show(const DropsRow& row, int step) const {
    if (settings_.progress)
      settings_.progress(fmt::format("{} {}", row.method, row.model), double(step) / kDropsSteps);
  }

  const DropJob& job_;
  const DropsSettings& settings_;
};

}  // namespace

std::vector<DropsRow> bench_drops(const DropJob& job, const DropsSettings& settings) {
  const DropsBench bench(job, settings);
  std::vector<DropsRow> rows;
  std::vector<Method> methods = make_methods(settings.methods, job, settings.measuring, 0, settings.progress);
  keep_model(methods, settings.model);
  until_interrupted([&] {
    for (const Method& method : methods) rows.push_back(bench.measure(method));
  });
  return rows;
}

}  // namespace lodestone
