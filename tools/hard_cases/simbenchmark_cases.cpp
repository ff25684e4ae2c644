// F1 to F4: the tasks of SimBenchmark (leggedrobotics, 2018) that are about spheres and boxes, with the
// figures published there for ODE. Those were made without error reduction and constraint force mixing, and
// so are these.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "reference/ode/ode_world.h"
#include "reference/random.h"
#include "tools/hard_cases/hard_case.h"

namespace lodestone {
namespace {

// F1: 7 × 7 elastic balls bounce for 20 s: the mean squared error of their energy.
namespace bouncing {

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
    balls.push_back(
        world.add_body({.shape = ball,
                        .mass = kMass,
                        .state = {.position = {kSpacing * (i % kSide), kSpacing * (i / kSide), kHeight}}}));

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

std::vector<HardCaseRow> measure_case(const HardCaseSettings&) {
  std::vector<HardCaseRow> rows;
  for (const auto& [dt, error] : kPublished)
    rows.push_back({.what = fmt::format("49 elastic balls, 20 s, dt {:g} s: mean squared energy error", dt),
                    .value = mean_squared_energy_error(dt),
                    .bound = kTolerance * error,
                    .unit = "J2"});
  return rows;
}

}  // namespace bouncing

// F2 and F3. SimBenchmark's "666": a cube of 6 × 6 × 6 balls, nearly touching, falls on a plane.
namespace ball_cube {

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
      const double z = random.uniform(), y = random.uniform(), x = random.uniform();
      const Vec3 cell(i / (kSide * kSide), i / kSide % kSide, i % kSide), jitter(x, y, z);
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
        if (const Vec3 apart = centers[i] - centers[j]; apart.squaredNorm() < 4 * kRadius * kRadius)
          add(2 * kRadius - apart.norm());
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

/// F2: "666": a cube of 6^3 balls collapses without friction or restitution: the mean sum of squared
/// penetrations.
std::vector<HardCaseRow> measure_ball_cube(const HardCaseSettings& settings) {
  std::vector<HardCaseRow> rows;
  for (const auto& [dt, published] : {Published{0.01, 0.0162}, {0.001, 1.57e-4}}) {
    if (settings.quick && dt < 0.01) continue;
    const std::string what =
        fmt::format("6^3 balls collapse, 10 s, dt {:g} s: mean sum of squared penetration", dt);
    add_rows(rows, {.what = what, .value = mean_squared_penetration(dt), .unit = "m2"}, published, 0.15);
  }
  return rows;
}

/// F3: the same, elastic, from a metre higher: the mean squared error of the energy.
std::vector<HardCaseRow> measure_elastic_ball_cube(const HardCaseSettings& settings) {
  std::vector<HardCaseRow> rows;
  for (const auto& [dt, published] : {Published{0.004, 1648.0}, {0.001, 112.3}}) {
    if (settings.quick && dt < 0.004) continue;
    const std::string what =
        fmt::format("6^3 elastic balls dropped 1 m, 10 s, dt {:g} s: mean squared energy error", dt);
    add_rows(rows, {.what = what, .value = mean_squared_energy_error(dt), .unit = "J2"}, published, 0.1);
  }
  return rows;
}

}  // namespace ball_cube

// F4: a box dragged over the ground makes 25 balls on top of it roll: the mean squared error of their
// velocities. SimBenchmark's "rolling": a box is dragged over the ground with 25 balls on top, which it makes
// roll.
namespace rolling {

constexpr double kBoxMass = 10.0, kBallMass = 1.0, kBallRadius = 0.5, kForce = 150.0, kGravity = 9.81;
constexpr double kGroundFriction = 0.4, kBallFriction = 0.8;
constexpr int kSide = 5, kBalls = kSide * kSide;
constexpr double kOverlap = 2e-5;  // m, at every contact, so that all are there from the first step
constexpr double kStep = 1e-3, kSeconds = 4.0;
const Vec3 kBoxSides{20, 20, 1};

struct RollingWorld {
  MaterialTable materials;
  std::unique_ptr<OdeWorld> world;
  OdeBodyId box, ball;  // the first of the balls

  RollingWorld(OdeGeometry geometry, bool friction_along_slip) {
    materials.replace(0, {.restitution = 0.0, .friction = kGroundFriction});
    const MaterialId ball_material = materials.add({.restitution = 0.0, .friction = kBallFriction});
    materials.set_law(0, ball_material, {.restitution = 0.0, .friction = kBallFriction});
    const OdeSettings settings{.gravity = {0, 0, -kGravity},
                               .erp = 0.0,
                               .cfm = 0.0,
                               .bounce_velocity = 0.0,
                               .friction_along_slip = friction_along_slip};
    world = std::make_unique<OdeWorld>(settings, materials);
    world->add_plane(Vec3::UnitZ(), 0.0, 0);
    box = world->add_body({.shape = std::make_shared<const Shape>(make_shape("slab", make_box(kBoxSides))),
                           .mass = kBoxMass,
                           .state = {.position = {0, 0, 0.5 * kBoxSides.z() - kOverlap}},
                           .geometry = geometry});
    add_balls(ball_material);
  }

  void add_balls(MaterialId material) {
    const auto shape = std::make_shared<const Shape>(make_sphere_shape(kBallRadius));
    for (int i = 0; i < kBalls; ++i) {
      const Vec3 position(2.0 * (i / kSide) - 4.0, 2.0 * (i % kSide) - 4.0,
                          kBoxSides.z() + kBallRadius - 3 * kOverlap);
      const OdeBodyId body = world->add_body(
          {.shape = shape, .mass = kBallMass, .material = material, .state = {.position = position}});
      if (i == 0) ball = body;
    }
  }
};

/// Accelerations of the box and of a ball, m/s²: the box slides under full friction, the balls roll on it
/// without sliding.
struct Accelerations {
  double box, ball;
};

Accelerations expected() {
  const double left = kForce - kGroundFriction * (kBoxMass + kBalls * kBallMass) * kGravity;
  const double ball_friction = left / kBoxMass / (3.5 / kBallMass + kBalls / kBoxMass);
  return {(left - kBalls * ball_friction) / kBoxMass, ball_friction / kBallMass};
}

/// Mean over the steps of the squared errors of box and ball, m²/s², as SimBenchmark takes it.
double mean_squared_velocity_error(OdeGeometry geometry, bool friction_along_slip, const Vec3& direction) {
  RollingWorld rolling(geometry, friction_along_slip);
  const Accelerations a = expected();
  const int steps = int(std::lround(kSeconds / kStep));
  double sum = 0.0;
  for (int i = 0; i < steps; ++i) {
    const Vec3 run = i * kStep * direction;
    sum += (rolling.world->state(rolling.box).velocity - a.box * run).squaredNorm() +
           (rolling.world->state(rolling.ball).velocity - a.ball * run).squaredNorm();
    rolling.world->add_force(rolling.box, kForce * direction, Vec3::Zero());
    rolling.world->step(kStep);
  }
  return sum / steps;
}

std::vector<HardCaseRow> measure_case(const HardCaseSettings&) {
  const Vec3 along_y = Vec3::UnitY(), slanted(0.5, 0.5 * std::numbers::sqrt3, 0.0);
  const auto row = [](const std::string& what, double value, double bound) {
    return HardCaseRow{
        .what = fmt::format("25 balls on a dragged box, {}: mean squared velocity error", what),
        .value = value,
        .bound = bound,
        .unit = "m2/s2"};
  };
  std::vector<HardCaseRow> rows;
  rows.push_back(row("force along y", mean_squared_velocity_error(OdeGeometry::box, true, along_y), 1e-6));
  rows.push_back(row("force at 30 deg", mean_squared_velocity_error(OdeGeometry::box, true, slanted), 1e-3));
  rows.push_back(row("force at 30 deg, box a trimesh",
                     mean_squared_velocity_error(OdeGeometry::trimesh, true, slanted), 1e-3));
  rows.push_back(row("force at 30 deg, friction along ODE's own axes",
                     mean_squared_velocity_error(OdeGeometry::box, false, slanted), 1e-3));
  rows.back().odes_own =
      "ODE bounds friction along two axes of its own, so its limit is higher off them and nothing moves; "
      "OdeSettings::friction_along_slip is the remedy";
  return rows;
}

}  // namespace rolling

}  // namespace

std::span<const HardCase> simbenchmark_cases() {
  static constexpr std::array kCases = {
      HardCase{"F1", bouncing::measure_case},
      HardCase{"F2", ball_cube::measure_ball_cube},
      HardCase{"F3", ball_cube::measure_elastic_ball_cube},
      HardCase{"F4", rolling::measure_case},
  };
  return kCases;
}

}  // namespace lodestone
