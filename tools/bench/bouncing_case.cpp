#include <fmt/format.h>

#include "reference/ode/ode_world.h"
#include "tools/bench/simbenchmark_cases.h"

namespace lodestone {
namespace {

constexpr int kSide = 7;
constexpr double kRadius = 0.1, kMass = 10.0, kHeight = 5.0, kSpacing = 2.0, kGravity = 9.81, kSeconds = 20.0;
constexpr double kTolerance = 1.01;

struct Published {
  double dt, error;  // s, J²
};
constexpr Published kPublished[] = {{0.01, 18808.0}, {0.004, 2982.7}, {0.001, 185.03}};

double mean_squared_energy_error(double dt) {
  MaterialTable materials;
  materials.replace(0, {.restitution = 1.0, .friction = 0.0});
  OdeWorld world({.gravity = {0, 0, -kGravity}, .erp = 0.0, .cfm = 0.0, .bounce_velocity = 0.0}, materials);
  world.add_plane(Vec3::UnitZ(), 0.0, 0);
  const auto ball = std::make_shared<const Shape>(make_sphere_shape(kRadius));
  std::vector<OdeBodyId> balls;
  for (int i = 0; i < kSide * kSide; ++i)
    balls.push_back(world.add_body({.shape = ball, .mass = kMass, .state = {.position = {kSpacing * (i % kSide), kSpacing * (i / kSide), kHeight}}}));

  const double energy_at_first = kSide * kSide * kMass * kGravity * kHeight;
  const int steps = int(std::lround(kSeconds / dt));
  double sum = 0.0;
  for (int i = 0; i < steps; ++i) {
    double energy = 0.0;
    for (const OdeBodyId body : balls) {
      const RigidState state = world.state(body);
      energy += kMass * (0.5 * state.velocity.squaredNorm() + kGravity * state.position.z());
    }
    sum += (energy - energy_at_first) * (energy - energy_at_first);
    world.step(dt);
  }
  return sum / steps;
}

}  // namespace

std::vector<HardCaseRow> measure_bouncing(const HardCaseSettings&) {
  std::vector<HardCaseRow> rows;
  for (const auto& [dt, error] : kPublished)
    rows.push_back({.what = fmt::format("49 elastic balls, 20 s, dt {:g} s: mean squared energy error", dt),
                    .value = mean_squared_energy_error(dt),
                    .bound = kTolerance * error,
                    .unit = "J2"});
  return rows;
}

}  // namespace lodestone
