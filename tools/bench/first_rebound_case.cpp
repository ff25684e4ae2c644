// S7.
#include <fmt/format.h>

#include "reference/trial.h"
#include "tools/bench/lone_body_cases.h"
#include "tools/bench/statistical_case_parts.h"
#include "tools/compare/drop_world.h"

namespace lodestone {
namespace {

constexpr double kBounceRise = 0.3;  // m/s: an impact, and not what gravity does between two samples
constexpr double kLongestFall = 2.0; // s

/// How high above the plane the centre of mass is bound for, as soon as an impact was seen: the same whatever the steps. No such impact: where it fell to.
double apex_of(DropWorld& world, double dt, int steps_a_sample) {
  const double sample = dt * steps_a_sample;
  RigidState before = world.state();
  for (double t = 0.0; t < kLongestFall; t += sample) {
    for (int i = 0; i < steps_a_sample; ++i) world.step(dt);
    const RigidState now = world.state();
    const double up = std::max(0.0, now.velocity.z());
    if (now.velocity.z() - before.velocity.z() + kCaseGravity * sample > kBounceRise) return now.position.z() + up * up / (2.0 * kCaseGravity);
    before = now;
  }
  return before.position.z();
}

struct Sample {
  double mean = 0.0, variance = 0.0;
  int count = 0;
};

Sample apexes_of(const DropJob& job, const DropMethod& method, std::uint64_t seed, double dt, int steps_a_sample, int trials) {
  DropWorld world(job, method);
  Sample sample{.count = trials};
  double squares = 0.0;
  for (int trial = 0; trial < trials; ++trial) {
    world.start(seed, std::uint32_t(trial));
    const double apex = apex_of(world, dt, steps_a_sample);
    sample.mean += apex / trials, squares += apex * apex / trials;
  }
  sample.variance = std::max(0.0, squares - sample.mean * sample.mean);
  return sample;
}

/// Over the standard error of the difference.
double difference(const Sample& a, const Sample& b) {
  return std::abs(a.mean - b.mean) / std::sqrt(a.variance / a.count + b.variance / b.count);
}

/// ODE in its own small steps, seen as seldom as a method that steps by `dt`.
Sample truth_of(const DropJob& job, double dt, int trials) {
  DropMethod truth = make_truth(job);
  const int steps = std::max(1, int(std::lround(dt / kObservationStep * truth.substeps())));
  std::get<OdeMethod>(truth.way).substeps = 1;
  return apexes_of(job, truth, 1, dt / steps, steps, trials);
}

}  // namespace

std::vector<HardCaseRow> measure_first_rebounds(const HardCaseSettings& settings) {
  const int trials = settings.quick ? 200 : 1000;
  std::vector<HardCaseRow> rows;
  for (const double e : {0.0, 0.5, 1.0}) {
    const DropJob job{.shape = box_of({0.2, 0.3, 0.4}), .conditions = {}, .material = {.restitution = e}};
    const auto signature = find_case_signature(*job.shape, job.law());
    for (const auto& [per_second, dt] : {std::pair{30, 1.0 / 30}, {60, 1.0 / 60}, {1000, 1.0 / 1000}}) {
      const Sample truth = truth_of(job, dt, trials);
      for (const auto& [model, name] : kBothModels) {
        const DropMethod method{"statistical", StatisticalMethod{model, signature}, ""};
        rows.push_back({.what = fmt::format("{} x box dropped, e {:g}, dt 1/{} s, {}: mean first rebound off ODE's, over its standard error", trials, e, per_second, name),
                        .value = difference(truth, apexes_of(job, method, 2, dt, 1, trials)), .bound = 3.3});
      }
    }
  }
  return rows;
}

}  // namespace lodestone
