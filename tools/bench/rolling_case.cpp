// SimBenchmark's "rolling": a box is dragged over the ground with 25 balls on top, which it makes roll.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "reference/ode/ode_world.h"
#include "tools/bench/simbenchmark_cases.h"

namespace lodestone {
namespace {

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
    const OdeSettings settings{.gravity = {0, 0, -kGravity}, .erp = 0.0, .cfm = 0.0, .bounce_velocity = 0.0, .friction_along_slip = friction_along_slip};
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
      const Vec3 position(2.0 * (i / kSide) - 4.0, 2.0 * (i % kSide) - 4.0, kBoxSides.z() + kBallRadius - 3 * kOverlap);
      const OdeBodyId body = world->add_body({.shape = shape, .mass = kBallMass, .material = material, .state = {.position = position}});
      if (i == 0) ball = body;
    }
  }
};

/// Accelerations of the box and of a ball, m/s²: the box slides under full friction, the balls roll on it without sliding.
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
    sum += (rolling.world->state(rolling.box).velocity - a.box * run).squaredNorm() + (rolling.world->state(rolling.ball).velocity - a.ball * run).squaredNorm();
    rolling.world->add_force(rolling.box, kForce * direction, Vec3::Zero());
    rolling.world->step(kStep);
  }
  return sum / steps;
}

}  // namespace

std::vector<HardCaseRow> measure_rolling(const HardCaseSettings&) {
  const Vec3 along_y = Vec3::UnitY(), slanted(0.5, 0.5 * std::numbers::sqrt3, 0.0);
  const auto row = [](const std::string& what, double value, double bound) {
    return HardCaseRow{.what = fmt::format("25 balls on a dragged box, {}: mean squared velocity error", what), .value = value, .bound = bound, .unit = "m2/s2"};
  };
  std::vector<HardCaseRow> rows;
  rows.push_back(row("force along y", mean_squared_velocity_error(OdeGeometry::box, true, along_y), 1e-6));
  rows.push_back(row("force at 30 deg", mean_squared_velocity_error(OdeGeometry::box, true, slanted), 1e-3));
  rows.push_back(row("force at 30 deg, box a trimesh", mean_squared_velocity_error(OdeGeometry::trimesh, true, slanted), 1e-3));
  rows.push_back(row("force at 30 deg, friction along ODE's own axes", mean_squared_velocity_error(OdeGeometry::box, false, slanted), 1e-3));
  rows.back().odes_own = "ODE bounds friction along two axes of its own, so its limit is higher off them and nothing moves; OdeSettings::friction_along_slip is the remedy";
  return rows;
}

}  // namespace lodestone
