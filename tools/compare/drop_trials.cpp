#include "tools/compare/drop_trials.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <mutex>

#include "reference/allowed_threads.h"
#include "tools/compare/drop_world.h"
#include "tools/compare/processor_time.h"
#include "tools/interrupt.h"
#include "tools/median.h"

namespace lodestone {
namespace {

constexpr int kTrialsInATask = 8;
constexpr int kTimedOdeDrops = 31;
constexpr int kTimedStatisticalBodies = 1024;
constexpr int kTimedRepeats = 5;
constexpr double kTimedSeconds = 10.0;
constexpr double kLeastTimedSeconds = 0.5;

// Steps until the horizon or until the body has settled; the observer sees the states that were reached by
// each 1/60 s.
DropObservation observe_drop(const DropJob& job, DropWorld& world, double dt) {
  DropObserver observer(*job.shape, drop_plane_normal(job.conditions));
  observer.sample(0.0, world.state());
  std::int64_t steps = 0;
  for (int k = 1; k * kObservationStep <= observer.horizon_s() + 1e-9 && !observer.settled(); ++k) {
    const std::int64_t before = steps;
    for (; double(steps + 1) * dt <= k * kObservationStep + 0.01 * dt; ++steps) world.step(dt);
    if (steps > before) observer.sample(double(steps) * dt, world.state());
  }
  DropObservation drop = observer.result();
  drop.table_extrapolations = world.table_extrapolations();
  return drop;
}

double measure_one_by_one(const DropJob& job, const DropMethod& method, const DropBatch& batch,
                          std::span<const DropObservation> observed) {
  std::vector<double> ns;
  DropWorld world(job, method);
  for (int trial = 0; trial < std::min(kTimedOdeDrops, int(observed.size())); ++trial) {
    const auto steps = std::int64_t(std::max(observed[trial].rest_time_s, kLeastTimedSeconds) / batch.dt_s);
    world.start(batch.seed, trial);
    ns.push_back(measure_processor_ns([&] {
                   for (std::int64_t i = 0; i < steps; ++i) world.step(batch.dt_s);
                 }) /
                 double(steps));
  }
  return median_of(std::move(ns));
}

// The part of a step that is not spent on pairs, which one body does not have.
double single_body_part(const StageTimes& times) {
  return 1.0 - (times.broad_phase_ms + times.pairs_ms + times.crowd_ms) / times.total_ms;
}

// While at least a quarter is awake, so that what a step costs whoever is awake is shared by many.
double measure_statistical(const DropJob& job, const DropMethod& method, const DropBatch& batch) {
  std::vector<double> ns_per_body_step;
  for (int repeat = 0; repeat < kTimedRepeats; ++repeat) {
    Manager manager = make_many_drops(job, std::get<StatisticalMethod>(method.way), batch.seed + repeat,
                                      kTimedStatisticalBodies);
    double spent = 0.0, body_steps = 0.0;
    int awake = kTimedStatisticalBodies;
    for (double t = 0; t < kTimedSeconds && awake > kTimedStatisticalBodies / 4; t += batch.dt_s) {
      body_steps += awake;
      const double ns = measure_processor_ns([&] { manager.step(batch.dt_s); });
      spent += ns * single_body_part(manager.report().times);
      awake = kTimedStatisticalBodies - manager.report().asleep;
    }
    ns_per_body_step.push_back(spent / body_steps);
  }
  return median_of(std::move(ns_per_body_step));
}

}  // namespace

std::vector<DropObservation> observe_drops(const DropJob& job, const DropMethod& method,
                                           const DropBatch& batch,
                                           const std::function<void(double)>& progress) {
  std::vector<DropObservation> drops(batch.trials);
  const int tasks = (batch.trials + kTrialsInATask - 1) / kTrialsInATask;
  std::mutex mutex;
  int done = 0;
  const auto run_task = [&](int task) {
    DropWorld world(job, method);
    for (int trial = task * kTrialsInATask; trial < std::min(batch.trials, (task + 1) * kTrialsInATask);
         ++trial) {
      throw_if_interrupted();
      world.start(batch.seed, trial);
      drops[trial] = observe_drop(job, world, batch.dt_s);
    }
    const std::scoped_lock lock(mutex);
    if (progress) progress(double(++done) / tasks);
  };
  tbb::task_arena arena(allowed_threads(batch.threads));
  arena.execute([&] { tbb::parallel_for(0, tasks, run_task, tbb::simple_partitioner()); });
  return drops;
}

double measure_ns_per_body_step(const DropJob& job, const DropMethod& method, const DropBatch& batch,
                                std::span<const DropObservation> observed) {
  if (std::holds_alternative<StatisticalMethod>(method.way)) return measure_statistical(job, method, batch);
  return measure_one_by_one(job, method, batch, observed);
}

}  // namespace lodestone
