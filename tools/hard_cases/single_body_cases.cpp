// F5, F6, F11, F12, F18: one body or two against what mechanics predicts.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>

#include "reference/error.h"
#include "reference/random.h"
#include "tools/hard_cases/case_parts.h"
#include "tools/hard_cases/hard_case.h"
#include "tools/hard_cases/scene_text.h"

namespace lodestone {
namespace {

// F5: a box on a slope, whichever way that faces: its speed after 2 s, by Coulomb's law.
namespace slopes {

constexpr double kDegree = std::numbers::pi / 180.0, kTilt = 25 * kDegree, kSeconds = 2.0, kStep = 1e-3;
constexpr double kMostCreep = 2e-3;  // m/s

double speed_after(double friction, double azimuth_deg) {
  const MaterialTable materials = materials_of(0.0, friction);
  OdeWorld world({.gravity = {0, 0, -kCaseGravity}}, materials);
  const Quat turn = Quat(Eigen::AngleAxisd(azimuth_deg * kDegree, Vec3::UnitZ())) *
                    Quat(Eigen::AngleAxisd(kTilt, Vec3::UnitY()));
  const Vec3 normal = turn * Vec3::UnitZ();
  world.add_plane(normal, 0.0, 0);
  // The box's own sides stay along x and y as far as the slope lets them.
  const RigidState start{.position = 0.1 * normal, .orientation = rotation_between(Vec3::UnitZ(), normal)};
  const OdeBodyId box = world.add_body({.shape = box_of({0.4, 0.4, 0.2}), .state = start});
  for (int i = 0; i < int(std::lround(kSeconds / kStep)); ++i) world.step(kStep);
  return world.state(box).velocity.norm();
}

HardCaseRow row_of(double friction, double azimuth_deg) {
  const double speed = speed_after(friction, azimuth_deg);
  const double expected = kCaseGravity * (std::sin(kTilt) - friction * std::cos(kTilt)) * kSeconds;
  const std::string what =
      fmt::format("box on a slope of 25 deg towards {:g} deg, friction {:g}", azimuth_deg, friction);
  if (expected > 0.0)
    return {.what = what + ": error of its speed after 2 s",
            .value = std::abs(speed / expected - 1.0),
            .bound = 0.05};
  return {.what = what + ": creep after 2 s", .value = speed, .bound = kMostCreep, .unit = "m/s"};
}

std::vector<HardCaseRow> measure_case(const HardCaseSettings&) {
  std::vector<HardCaseRow> rows;
  for (const double friction : {0.45, 0.48, 0.55})
    for (const double azimuth_deg : {0.0, 22.5, 45.0}) rows.push_back(row_of(friction, azimuth_deg));
  return rows;
}

}  // namespace slopes

// F6: a ball dropped from twenty heights: how high it rises again.
namespace rebounds {

constexpr int kHeights = 20;
constexpr double kLowest = 0.9, kHighest = 1.1, kRadius = 0.1, kRestitution = 0.5;
constexpr double kIdeal = kRestitution * kRestitution;

/// Rebound over drop height.
double rebound_from(double height, double dt) {
  const MaterialTable materials = materials_of(kRestitution, 0.0);
  OdeWorld world({.gravity = {0, 0, -kCaseGravity}}, materials);
  world.add_plane(Vec3::UnitZ(), 0.0, 0);
  const OdeBodyId ball =
      world.add_body({.shape = ball_of(kRadius), .state = {.position = {0, 0, kRadius + height}}});
  const auto speed = [&] { return world.state(ball).velocity.z(); };
  for (int i = 0; i < int(2.0 / dt) && speed() <= 0.0; ++i) world.step(dt);
  double top = 0.0;
  for (; speed() > 0.0; world.step(dt)) top = worse(top, world.state(ball).position.z());
  return (top - kRadius) / height;
}

struct Band {
  int steps_per_s;
  double below, above;  // of the ideal
};

std::vector<HardCaseRow> measure_case(const HardCaseSettings&) {
  std::vector<HardCaseRow> rows;
  for (const auto& [steps_per_s, below, above] :
       {Band{1000, 0.06, 0.06}, {500, 0.06, 0.06}, {240, 0.06, 0.06}, {120, 0.10, 0.06}, {60, 0.18, 0.04}}) {
    std::vector<double> rebounds;
    for (int i = 0; i < kHeights; ++i)
      rebounds.push_back(
          rebound_from(kLowest + (kHighest - kLowest) * i / (kHeights - 1), 1.0 / steps_per_s));
    const std::string what = fmt::format("ball dropped from 20 heights, e .5, dt 1/{} s: ", steps_per_s);
    rows.push_back({.what = what + "highest rebound over drop",
                    .value = std::ranges::max(rebounds),
                    .bound = kIdeal * (1.0 + above)});
    rows.push_back({.what = what + "lowest rebound over drop",
                    .value = std::ranges::min(rebounds),
                    .bound = kIdeal * (1.0 - below),
                    .side = BoundSide::at_least});
  }
  return rows;
}

}  // namespace rebounds

// F11: a box that spins freely near its middle axis: energy and angular momentum.
namespace free_top {

constexpr double kSeconds = 10.0;

struct Drift {
  double energy_gain = 0.0, energy_loss = 0.0,
         momentum_change = 0.0;  // each the greatest, relative to the start
};

Drift drift_of(double dt) {
  const MaterialTable materials;
  OdeWorld world({.gravity = Vec3::Zero()}, materials);
  const auto box = box_of({1, 2, 0.5});
  // The middle moment of inertia is about x here; a little off it, so that the box tumbles.
  const OdeBodyId body = world.add_body({.shape = box, .state = {.angular_velocity = {10, 0.01, 0.01}}});
  const double energy = kinetic_energy(*box, 1.0, world.state(body));
  const Vec3 momentum = angular_momentum(*box, 1.0, world.state(body));
  Drift drift;
  for (int i = 0; i < int(std::lround(kSeconds / dt)); ++i) {
    world.step(dt);
    const RigidState state = world.state(body);
    const double gain = kinetic_energy(*box, 1.0, state) / energy - 1.0;
    drift.energy_gain = worse(drift.energy_gain, gain);
    drift.energy_loss = worse(drift.energy_loss, -gain);
    drift.momentum_change = std::max(
        drift.momentum_change, (angular_momentum(*box, 1.0, state) - momentum).norm() / momentum.norm());
  }
  return drift;
}

std::vector<HardCaseRow> measure_case(const HardCaseSettings&) {
  std::vector<HardCaseRow> rows;
  for (const int steps_per_s : {1000, 240, 60}) {
    const Drift drift = drift_of(1.0 / steps_per_s);
    const std::string what =
        fmt::format("box spinning freely near its middle axis, 10 rad/s, 10 s, dt 1/{} s: ", steps_per_s);
    rows.push_back({.what = what + "energy gained", .value = drift.energy_gain, .bound = 1e-9});
    rows.push_back({.what = what + "energy lost", .value = drift.energy_loss, .bound = 0.1});
    rows.push_back(
        {.what = what + "change of angular momentum", .value = drift.momentum_change, .bound = 0.05});
  }
  return rows;
}

}  // namespace free_top

// F12: needles and laths that fall; an inertia that no body has.
namespace slender_bodies {

constexpr double kSeconds = 10.0, kDropHeight = 0.5;

double largest_inertia_ratio(const Shape& shape) {
  const Vec3 moments = find_principal_moments(shape.inertia_per_mass);
  return moments.maxCoeff() / moments.minCoeff();
}

struct Fall {
  double energy_gain = 0.0;                       ///< greatest energy over that at the start
  double speed_at_end = 0.0, depth_at_end = 0.0;  ///< m/s of any point; m of the lowest point below the floor
};

/// Falls spinning onto a floor.
Fall fall_of(const std::shared_ptr<const Shape>& shape, double dt, std::uint32_t trial) {
  const MaterialTable materials = materials_of(0.3, 0.5);
  OdeWorld world({.gravity = {0, 0, -kCaseGravity}, .auto_disable = true}, materials);
  world.add_plane(Vec3::UnitZ(), 0.0, 0);
  RandomStream random(12, trial, 0);
  const RigidState start{.position = {0, 0, shape->radius + kDropHeight},
                         .orientation = random.orientation(),
                         .velocity = random.direction(),
                         .angular_velocity = 10.0 * random.direction()};
  const OdeBodyId body = world.add_body({.shape = shape, .state = start});
  const auto energy = [&] {
    return kinetic_energy(*shape, 1.0, world.state(body)) + kCaseGravity * world.state(body).position.z();
  };
  const double first = energy();
  Fall fall;
  for (int i = 0; i < int(std::lround(kSeconds / dt)); ++i) {
    world.step(dt);
    fall.energy_gain = worse(fall.energy_gain, energy() / first - 1.0);
  }
  const RigidState end = world.state(body);
  fall.speed_at_end = end.velocity.norm() + shape->radius * end.angular_velocity.norm();
  for (const Vec3& vertex : shape->hull.vertices)
    fall.depth_at_end = worse(fall.depth_at_end, -(end.position + end.orientation * vertex).z());
  if (world.counters().states_recovered > 0) fall.energy_gain = std::nan("");
  return fall;
}

void add_rows(std::vector<HardCaseRow>& rows, const std::string& name,
              const std::shared_ptr<const Shape>& shape, double dt) {
  constexpr int kTrials = 20;
  Fall worst;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Fall fall = fall_of(shape, dt, trial);
    worst.energy_gain = worse(worst.energy_gain, fall.energy_gain);
    worst.speed_at_end = worse(worst.speed_at_end, fall.speed_at_end);
    worst.depth_at_end = worse(worst.depth_at_end, fall.depth_at_end);
  }
  const std::string what = fmt::format("20 drops of a {}, dt {:.3g} s: ", name, dt);
  rows.push_back({.what = what + "energy gained", .value = worst.energy_gain, .bound = 0.01});
  rows.push_back(
      {.what = what + "fastest point after 10 s", .value = worst.speed_at_end, .bound = 0.02, .unit = "m/s"});
  rows.push_back({.what = what + "depth in the floor after 10 s",
                  .value = worst.depth_at_end,
                  .bound = 1e-3,
                  .unit = "m"});
}

bool is_refused(const Mat3& inertia_per_mass) {
  try {
    make_shape("odd", make_box({1, 1, 1}), {.inertia_per_mass_m2 = inertia_per_mass});
  } catch (const InputError& error) {
    return std::string_view(error.what()).starts_with("odd: inertia: found");
  }
  return false;
}

/// As a shape's and as a scene's; among them one that a body can have, which must pass.
HardCaseRow impossible_inertias() {
  const auto scene_with = [](const std::string& diagonal) {
    return "version: 1\nshapes: {crate: {box_m: [1, 1, 1], mass_kg: 1, inertia: " + diagonal +
           "}}\nground: [{plane: {normal: [0, 0, 1], offset_m: 0}}]\n"
           "bodies:\n  - {shape: crate, position_m: [0, 0, 1]}\n";
  };
  const std::string scenes[] = {
      scene_with("[[1, 0, 0], [0, 1, 0], [0, 0, 100]]"), scene_with("[[1, 0, 0], [0, 1, 0], [0, 0, -1]]"),
      scene_with("[[1, 2, 0], [2, 1, 0], [0, 0, 1]]"), scene_with("[[0, 0, 0], [0, 0, 0], [0, 0, 0]]"),
      scene_with("[[.nan, 0, 0], [0, 1, 0], [0, 0, 1]]")};
  int wrong = count_unclear(scenes, "inertia") +
              !scene_error_of(scene_with("[[1, 0, 0], [0, 1, 0], [0, 0, 1.9]]")).empty();
  for (const Vec3& moments : {Vec3(1, 1, 100), Vec3(1, 1, -1), Vec3(0, 0, 0), Vec3(1, 1, std::nan(""))})
    wrong += !is_refused(Mat3(moments.asDiagonal()));
  wrong += is_refused(Mat3(Vec3(1, 1, 1.9).asDiagonal()));
  return {
      .what = "inertias that no body has, (1, 1, 100) among them: accepted, or refused without a clear error",
      .value = double(wrong),
      .bound = 0.0};
}

std::vector<HardCaseRow> measure_case(const HardCaseSettings&) {
  const auto needle = share(make_shape("needle", make_needle(1.0, 0.0045)));
  const auto lath = box_of({1.0, 0.01, 0.001});
  std::vector<HardCaseRow> rows{impossible_inertias()};
  for (const double dt : {1e-3, 1.0 / 240, 1.0 / 60}) {
    add_rows(rows, fmt::format("needle, inertia ratio {:.3g}", largest_inertia_ratio(*needle)), needle, dt);
    add_rows(rows, fmt::format("plate, inertia ratio {:.3g}", largest_inertia_ratio(*lath)), lath, dt);
  }
  return rows;
}

}  // namespace slender_bodies

// F18: two bodies that meet head-on without gravity or loss: momentum and energy.
namespace head_on {

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
  return {(momentum - momentum_before).norm() / momentum_before.norm(),
          std::abs(energy / energy_before - 1.0), (a.velocity - expected * Vec3::UnitX()).norm() / kSpeed};
}

void add_rows(std::vector<HardCaseRow>& rows, const std::string& name, const Errors& errors,
              const std::string& odes_own = "") {
  const std::string what = "two " + name + " of 1 and 3 kg meet head-on, e 1: error of ";
  rows.push_back({.what = what + "momentum", .value = errors.momentum, .bound = 1e-9});
  rows.push_back({.what = what + "energy", .value = errors.energy, .bound = 1e-9, .odes_own = odes_own});
  rows.push_back({.what = what + "the lighter's velocity",
                  .value = errors.velocity,
                  .bound = 1e-9,
                  .odes_own = odes_own});
}

std::vector<HardCaseRow> measure_case(const HardCaseSettings&) {
  const auto ball = ball_of(0.5 * kWidth), cube = box_of(Vec3::Constant(kWidth));
  std::vector<HardCaseRow> rows;
  for (const int steps_per_s : {1000, 60}) {
    add_rows(rows, fmt::format("balls, dt 1/{} s,", steps_per_s), errors_of(ball, 1.0 / steps_per_s, 0.0));
    add_rows(rows, fmt::format("trimesh cubes, dt 1/{} s,", steps_per_s),
             errors_of(cube, 1.0 / steps_per_s, 0.0));
  }
  add_rows(rows, "balls, dt 1/1000 s, default cfm,", errors_of(ball, 1e-3, OdeSettings{}.cfm),
           "ODE's constraint force mixing, 1e-10 by default, without which dWorldStep gives up on stacks, "
           "softens an impact by about cfm x mass / dt");
  return rows;
}

}  // namespace head_on

}  // namespace

std::span<const HardCase> single_body_cases() {
  static constexpr std::array kCases = {
      HardCase{"F5", slopes::measure_case},    HardCase{"F6", rebounds::measure_case},
      HardCase{"F11", free_top::measure_case}, HardCase{"F12", slender_bodies::measure_case},
      HardCase{"F18", head_on::measure_case},
  };
  return kCases;
}

}  // namespace lodestone
