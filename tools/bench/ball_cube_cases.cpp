// SimBenchmark's "666": a cube of 6 × 6 × 6 balls, nearly touching, falls on a plane.
#include <fmt/format.h>

#include <functional>

#include "reference/ode/ode_world.h"
#include "reference/random.h"
#include "tools/bench/simbenchmark_cases.h"

namespace lodestone {
namespace {

constexpr int kSide = 6;
constexpr double kRadius = 0.1, kMass = 10.0, kGap = 0.21, kJitter = 1e-3, kGravity = 9.81, kSeconds = 10.0;

struct BallCube {
  MaterialTable materials;
  std::unique_ptr<OdeWorld> world;
  std::vector<OdeBodyId> balls;

  BallCube(double height, double restitution) {
    materials.replace(0, {.restitution = restitution, .friction = 0.0});
    const OdeSettings settings{.gravity = {0, 0, -kGravity}, .erp = 0.0, .cfm = 0.0, .bounce_velocity = 0.0};
    world = std::make_unique<OdeWorld>(settings, materials);
    world->add_plane(Vec3::UnitZ(), 0.0, 0);
    const auto ball = std::make_shared<const Shape>(make_sphere_shape(kRadius));
    for (int i = 0; i < kSide * kSide * kSide; ++i) {
      RandomStream random(42, i, 0);
      const Vec3 cell(i / (kSide * kSide), i / kSide % kSide, i % kSide), jitter(random.uniform(), random.uniform(), random.uniform());
      const Vec3 position = kGap * cell + kJitter * jitter + height * Vec3::UnitZ();
      balls.push_back(world->add_body({.shape = ball, .mass = kMass, .state = {.position = position}}));
    }
  }

  /// Σ depth² of balls in each other and in the plane, m².
  double squared_penetration() const {
    std::vector<Vec3> centers;
    for (const OdeBodyId ball : balls) centers.push_back(world->state(ball).position);
    double sum = 0.0;
    const auto add = [&](double depth) { sum += depth > 0.0 ? depth * depth : 0.0; };
    for (std::size_t i = 0; i < centers.size(); ++i) {
      add(kRadius - centers[i].z());
      for (std::size_t j = i + 1; j < centers.size(); ++j)
        if (const Vec3 apart = centers[i] - centers[j]; apart.squaredNorm() < 4 * kRadius * kRadius) add(2 * kRadius - apart.norm());
    }
    return sum;
  }

  double energy() const {
    double energy = 0.0;
    for (const OdeBodyId ball : balls) {
      const RigidState state = world->state(ball);
      energy += kMass * (0.5 * state.velocity.squaredNorm() + kGravity * state.position.z());
    }
    return energy;
  }

  /// Over the steps of the run, each seen before it is taken.
  double mean_of(double dt, const std::function<double()>& figure) {
    const int steps = int(std::lround(kSeconds / dt));
    double sum = 0.0;
    for (int i = 0; i < steps; ++i) {
      sum += figure();
      world->step(dt);
    }
    return sum / steps;
  }
};

double mean_squared_penetration(double dt) {
  BallCube cube(0.101, 0.0);
  return cube.mean_of(dt, [&] { return cube.squared_penetration(); });
}

double mean_squared_energy_error(double dt) {
  BallCube cube(1.101, 1.0);
  const double first = cube.energy();
  return cube.mean_of(dt, [&] { return (cube.energy() - first) * (cube.energy() - first); });
}

struct Published {
  double dt, figure;  // s
};

/// The published figure on either side.
void add_rows(std::vector<HardCaseRow>& rows, HardCaseRow row, double published, double tolerance) {
  row.bound = published * (1.0 + tolerance);
  rows.push_back(row);
  row.bound = published * (1.0 - tolerance);
  row.side = BoundSide::at_least;
  rows.push_back(row);
}

}  // namespace

std::vector<HardCaseRow> measure_ball_cube(const HardCaseSettings& settings) {
  std::vector<HardCaseRow> rows;
  for (const auto& [dt, published] : {Published{0.01, 0.0162}, {0.001, 1.57e-4}}) {
    if (settings.quick && dt < 0.01) continue;
    const std::string what = fmt::format("6^3 balls collapse, 10 s, dt {:g} s: mean sum of squared penetration", dt);
    add_rows(rows, {.what = what, .value = mean_squared_penetration(dt), .unit = "m2"}, published, 0.15);
  }
  return rows;
}

std::vector<HardCaseRow> measure_elastic_ball_cube(const HardCaseSettings& settings) {
  std::vector<HardCaseRow> rows;
  for (const auto& [dt, published] : {Published{0.004, 1648.0}, {0.001, 112.3}}) {
    if (settings.quick && dt < 0.004) continue;
    const std::string what = fmt::format("6^3 elastic balls dropped 1 m, 10 s, dt {:g} s: mean squared energy error", dt);
    add_rows(rows, {.what = what, .value = mean_squared_energy_error(dt), .unit = "J2"}, published, 0.1);
  }
  return rows;
}

}  // namespace lodestone
