#include "tools/compare/pile_trials.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <mutex>

#include "reference/allowed_threads.h"
#include "reference/trial.h"
#include "tools/compare/processor_time.h"
#include "tools/interrupt.h"

namespace lodestone {
namespace {

constexpr double kConvergingSeconds = 3.0;

std::vector<RigidState> states_of(const PileWorld& world) {
  std::vector<RigidState> states;
  for (int i = 0; i < world.bodies(); ++i) states.push_back(world.state(i));
  return states;
}

std::uint64_t seed_of_pile(const PileBatch& batch, int pile) {
  return 1000 * batch.seed + std::uint64_t(pile);
}

PileWorld make_world(const DropJob& job, const DropMethod& method, const PileBatch& batch, int pile) {
  const std::uint64_t seed = seed_of_pile(batch, pile);
  return {job, method, make_bin(batch.conditions.side), make_pile_start(*job.shape, batch.conditions, seed),
          seed};
}

// The observer sees the states that were reached by each 1/60 s.
PileObservation observe_pile(const DropJob& job, PileWorld world, const PileOverlap& overlap, double dt) {
  PileObserver observer(*job.shape, overlap);
  observer.sample(0.0, states_of(world));
  std::int64_t steps = 0;
  for (int k = 1; k * kObservationStep <= observer.horizon_s() + 1e-9; ++k) {
    const std::int64_t before = steps;
    for (; double(steps + 1) * dt <= k * kObservationStep + 0.01 * dt; ++steps) world.step(dt);
    if (steps > before) observer.sample(double(steps) * dt, states_of(world));
  }
  return observer.result();
}

Vec3 mean_velocity(const PileWorld& world) {
  Vec3 sum = Vec3::Zero();
  for (const RigidState& state : states_of(world)) sum += state.velocity;
  return sum / world.bodies();
}

}  // namespace

std::vector<PileObservation> observe_piles(const DropJob& job, const DropMethod& method,
                                           const PileOverlap& overlap, const PileBatch& batch,
                                           const std::function<void(double)>& progress) {
  std::vector<PileObservation> piles(std::size_t(batch.piles));
  std::mutex mutex;
  int done = 0;
  const auto run = [&](int pile) {
    throw_if_interrupted();
    piles[std::size_t(pile)] = observe_pile(job, make_world(job, method, batch, pile), overlap, batch.dt_s);
    const std::scoped_lock lock(mutex);
    if (progress) progress(double(++done) / batch.piles);
  };
  tbb::task_arena arena(allowed_threads(batch.threads));
  arena.execute([&] { tbb::parallel_for(0, batch.piles, run, tbb::simple_partitioner()); });
  return piles;
}

double measure_ns_per_body_step(const DropJob& job, const DropMethod& method, const PileBatch& batch,
                                double until_s) {
  PileWorld world = make_world(job, method, batch, 0);
  double spent = 0.0, body_steps = 0.0;
  int awake = world.bodies();
  for (double t = 0.0; t < until_s && awake > 0; t += batch.dt_s) {
    body_steps += awake;
    spent += measure_processor_ns([&] { world.step(batch.dt_s); });
    awake = world.awake();
  }
  return spent / std::max(1.0, body_steps);
}

double measure_momentum_residual(const DropJob& job, const DropMethod& method, const PileBatch& batch) {
  const std::vector<RigidState> starts =
      make_converging_start(*job.shape, batch.conditions.bodies, batch.seed);
  PileWorld world(job, method, make_empty_space(), starts, batch.seed);
  double mean_speed = 0.0;
  for (const RigidState& start : starts) mean_speed += start.velocity.norm() / double(starts.size());
  const Vec3 before = mean_velocity(world);
  double change = 0.0;
  for (double t = 0.0; t < kConvergingSeconds; t += batch.dt_s) {
    world.step(batch.dt_s);
    change = std::max(change, (mean_velocity(world) - before).norm());
  }
  return mean_speed > 0.0 ? change / mean_speed : 0.0;
}

}  // namespace lodestone
