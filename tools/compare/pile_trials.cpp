#include "tools/compare/pile_trials.h"

#include <algorithm>

#include "tools/compare/processor_time.h"
#include "tools/compare/trials.h"

namespace lodestone {
namespace {

constexpr double kConvergingSeconds = 3.0;

std::vector<RigidState> states_of(const MethodWorld& world) {
  std::vector<RigidState> states;
  for (int i = 0; i < world.bodies(); ++i) states.push_back(world.state(i));
  return states;
}

std::uint64_t seed_of_pile(const PileBatch& batch, int pile) {
  return 1000 * batch.seed + std::uint64_t(pile);
}

MethodWorld make_world(const DropJob& job, const Method& method, const PileBatch& batch, int pile) {
  const std::uint64_t seed = seed_of_pile(batch, pile);
  return {job,
          method,
          {.planes = make_bin(batch.conditions.side), .seed = seed},
          make_pile_start(*job.shape, batch.conditions, seed)};
}

PileObservation observe_pile(const DropJob& job, MethodWorld world, const PileOverlap& overlap, double dt) {
  PileObserver observer(*job.shape, overlap);
  watch(world, dt, observer.horizon_s(), [&](double time_s) {
    observer.sample(time_s, states_of(world));
    return true;
  });
  return observer.result();
}

Vec3 mean_velocity(const MethodWorld& world) {
  Vec3 sum = Vec3::Zero();
  for (const RigidState& state : states_of(world)) sum += state.velocity;
  return sum / world.bodies();
}

}  // namespace

std::vector<PileObservation> observe_piles(const DropJob& job, const Method& method,
                                           const PileOverlap& overlap, const PileBatch& batch,
                                           const std::function<void(double)>& progress) {
  std::vector<PileObservation> piles(std::size_t(batch.piles));
  run_trials(
      batch.piles, batch.threads,
      [&](int pile) {
        piles[std::size_t(pile)] =
            observe_pile(job, make_world(job, method, batch, pile), overlap, batch.dt_s);
      },
      progress);
  return piles;
}

double measure_ns_per_body_step(const DropJob& job, const Method& method, const PileBatch& batch,
                                double until_s) {
  MethodWorld world = make_world(job, method, batch, 0);
  double spent = 0.0, body_steps = 0.0;
  int awake = world.bodies();
  for (double t = 0.0; t < until_s && awake > 0; t += batch.dt_s) {
    body_steps += awake;
    spent += measure_processor_ns([&] { world.step(batch.dt_s); });
    awake = world.awake();
  }
  return spent / std::max(1.0, body_steps);
}

double measure_momentum_residual(const DropJob& job, const Method& method, const PileBatch& batch) {
  const std::vector<RigidState> starts =
      make_converging_start(*job.shape, batch.conditions.bodies, batch.seed);
  const WorldSettings empty_space{.gravity = Vec3::Zero(), .seed = batch.seed, .sleeping = false};
  MethodWorld world(job, method, empty_space, starts);
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
