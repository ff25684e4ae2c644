#include "tools/compare/drop_trials.h"

#include <algorithm>
#include <cmath>

#include "reference/random.h"
#include "tools/compare/processor_time.h"
#include "tools/compare/trials.h"
#include "tools/interrupt.h"
#include "tools/median.h"

namespace lodestone {
namespace {

constexpr double kFarApart = 60.0;  // sizes of a body: farther than any drop goes
constexpr int kTrialsInATask = 8;
constexpr int kTimedOdeDrops = 31;
constexpr int kTimedStatisticalBodies = 1024;
constexpr int kTimedRepeats = 5;
constexpr double kTimedSeconds = 10.0;
constexpr double kLeastTimedSeconds = 0.5;

// Draws are keyed by (seed, body, event), and the body is the first of its manager: each drop needs a seed of
// its own.
std::uint64_t seed_of_drop(std::uint64_t seed, std::uint32_t trial) {
  RandomStream random(seed, trial, 0x5eed);
  return std::uint64_t(random.uniform() * 0x1p53);
}

WorldSettings over_the_ground(const DropJob& job) {
  if (job.ground == DropGround::plane) return {.planes = {{drop_plane_normal(job.conditions), 0.0}}};
  return {.solids = make_drop_ground(job.ground, job.shape->size)};
}

// Until the horizon or until the body has settled.
DropObservation observe_drop(const DropJob& job, MethodWorld& world, double dt) {
  DropObserver observer(*job.shape, drop_plane_normal(job.conditions));
  watch(world, dt, observer.horizon_s(), [&](double time_s) {
    observer.sample(time_s, world.state());
    return !observer.settled();
  });
  DropObservation drop = observer.result();
  if (const Manager* manager = world.manager())
    drop.table_extrapolations = manager->report().counters.table_extrapolations;
  return drop;
}

double measure_one_by_one(const DropJob& job, const Method& method, const DropBatch& batch,
                          std::span<const DropObservation> observed) {
  std::vector<double> ns;
  DropWorld drops(job, method);
  for (int trial = 0; trial < std::min(kTimedOdeDrops, int(observed.size())); ++trial) {
    const auto steps = std::int64_t(std::max(observed[trial].rest_time_s, kLeastTimedSeconds) / batch.dt_s);
    MethodWorld& world = drops.start(batch.seed, std::uint32_t(trial));
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
double measure_statistical(const DropJob& job, const Method& method, const DropBatch& batch) {
  std::vector<double> ns_per_body_step;
  for (int repeat = 0; repeat < kTimedRepeats; ++repeat) {
    MethodWorld world = make_many_drops(job, method, batch.seed + repeat, kTimedStatisticalBodies);
    double spent = 0.0, body_steps = 0.0;
    int awake = kTimedStatisticalBodies;
    for (double t = 0; t < kTimedSeconds && awake > kTimedStatisticalBodies / 4; t += batch.dt_s) {
      body_steps += awake;
      const double ns = measure_processor_ns([&] { world.step(batch.dt_s); });
      const StepReport& report = world.manager()->report();
      spent += ns * single_body_part(report.times);
      awake = kTimedStatisticalBodies - report.asleep;
    }
    ns_per_body_step.push_back(spent / body_steps);
  }
  return median_of(std::move(ns_per_body_step));
}

}  // namespace

DropWorld::DropWorld(const DropJob& job, const Method& method)
    : job_(job), world_(job, method, over_the_ground(job), {}) {}

MethodWorld& DropWorld::start(std::uint64_t seed, std::uint32_t trial) {
  const RigidState start = drop_state(*job_.shape, job_.conditions, seed, trial);
  world_.restart(seed_of_drop(seed, trial), {&start, 1});
  return world_;
}

MethodWorld make_many_drops(const DropJob& job, const Method& method, std::uint64_t seed, int bodies,
                            int threads) {
  const Vec3 across = Vec3::UnitY(), along = across.cross(drop_plane_normal(job.conditions));
  const int side = int(std::ceil(std::sqrt(double(bodies))));
  std::vector<RigidState> starts;
  for (int i = 0; i < bodies; ++i) {
    starts.push_back(drop_state(*job.shape, job.conditions, seed, std::uint32_t(i)));
    starts.back().position +=
        kFarApart * job.shape->size * ((i % side - side / 2) * across + (i / side - side / 2) * along);
  }
  WorldSettings settings = over_the_ground(job);
  settings.seed = seed;
  settings.threads = threads;
  return {job, method, settings, starts};
}

std::vector<DropObservation> observe_drops(const DropJob& job, const Method& method, const DropBatch& batch,
                                           const std::function<void(double)>& progress) {
  std::vector<DropObservation> drops(std::size_t(batch.trials));
  const int tasks = (batch.trials + kTrialsInATask - 1) / kTrialsInATask;
  run_trials(
      tasks, batch.threads,
      [&](int task) {
        DropWorld world(job, method);
        const int end = std::min(batch.trials, (task + 1) * kTrialsInATask);
        for (int trial = task * kTrialsInATask; trial < end; ++trial) {
          throw_if_interrupted();
          drops[std::size_t(trial)] =
              observe_drop(job, world.start(batch.seed, std::uint32_t(trial)), batch.dt_s);
        }
      },
      progress);
  return drops;
}

double measure_ns_per_body_step(const DropJob& job, const Method& method, const DropBatch& batch,
                                std::span<const DropObservation> observed) {
  const bool on_plane = job.ground == DropGround::plane;
  if (on_plane && std::holds_alternative<StatisticalMethod>(method.way))
    return measure_statistical(job, method, batch);
  return measure_one_by_one(job, method, batch, observed);
}

}  // namespace lodestone
