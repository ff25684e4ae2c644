#include <fmt/format.h>

#include <cmath>

#include "tools/bench/body_cases.h"
#include "tools/bench/case_parts.h"

namespace lodestone {
namespace {

constexpr double kLightMass = 1.0, kHeavyMass = 3.0, kSpeed = 1.0, kWidth = 0.2;

/// Relative errors after two bodies of one shape met at equal speeds.
struct Errors {
  double momentum, energy, velocity;
};

Errors errors_of(const std::shared_ptr<const Shape>& shape, double dt, double cfm) {
  const MaterialTable materials = materials_of(1.0, 0.0);
  OdeWorld world({.gravity = Vec3::Zero(), .cfm = cfm}, materials);
  const auto add = [&](double mass, double side) {
    const RigidState start{.position = {-side * (kWidth + 0.1), 0, 0}, .velocity = {side * kSpeed, 0, 0}};
    return world.add_body({.shape = shape, .mass = mass, .state = start});
  };
  const OdeBodyId light = add(kLightMass, 1.0), heavy = add(kHeavyMass, -1.0);
  for (int i = 0; i < int(1.0 / dt); ++i) world.step(dt);
  const RigidState a = world.state(light), b = world.state(heavy);
  const Vec3 momentum = kLightMass * a.velocity + kHeavyMass * b.velocity;
  const double energy = kinetic_energy(*shape, kLightMass, a) + kinetic_energy(*shape, kHeavyMass, b);
  const Vec3 momentum_before = (kLightMass - kHeavyMass) * kSpeed * Vec3::UnitX();
  const double energy_before = 0.5 * (kLightMass + kHeavyMass) * kSpeed * kSpeed;
  // In the frame of their common centre each just turns round.
  const double expected = 2.0 * (kLightMass - kHeavyMass) / (kLightMass + kHeavyMass) * kSpeed - kSpeed;
  return {(momentum - momentum_before).norm() / momentum_before.norm(), std::abs(energy / energy_before - 1.0), (a.velocity - expected * Vec3::UnitX()).norm() / kSpeed};
}

void add_rows(std::vector<HardCaseRow>& rows, const std::string& name, const Errors& errors, const std::string& odes_own = "") {
  const std::string what = "two " + name + " of 1 and 3 kg meet head-on, e 1: error of ";
  rows.push_back({.what = what + "momentum", .value = errors.momentum, .bound = 1e-9});
  rows.push_back({.what = what + "energy", .value = errors.energy, .bound = 1e-9, .odes_own = odes_own});
  rows.push_back({.what = what + "the lighter's velocity", .value = errors.velocity, .bound = 1e-9, .odes_own = odes_own});
}

}  // namespace

std::vector<HardCaseRow> measure_head_on(const HardCaseSettings&) {
  const auto ball = ball_of(0.5 * kWidth), cube = box_of(Vec3::Constant(kWidth));
  std::vector<HardCaseRow> rows;
  for (const int steps_per_s : {1000, 60}) {
    add_rows(rows, fmt::format("balls, dt 1/{} s,", steps_per_s), errors_of(ball, 1.0 / steps_per_s, 0.0));
    add_rows(rows, fmt::format("trimesh cubes, dt 1/{} s,", steps_per_s), errors_of(cube, 1.0 / steps_per_s, 0.0));
  }
  add_rows(rows, "balls, dt 1/1000 s, default cfm,", errors_of(ball, 1e-3, OdeSettings{}.cfm),
           "ODE's constraint force mixing, 1e-10 by default, without which dWorldStep gives up on stacks, softens an impact by about cfm x mass / dt");
  return rows;
}

}  // namespace lodestone
