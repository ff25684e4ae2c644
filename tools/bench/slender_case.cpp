#include <fmt/format.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "reference/error.h"
#include "reference/random.h"
#include "tools/bench/body_cases.h"
#include "tools/bench/case_parts.h"
#include "tools/bench/scene_text.h"

namespace lodestone {
namespace {

constexpr double kSeconds = 10.0, kDropHeight = 0.5;

double largest_inertia_ratio(const Shape& shape) {
  const Vec3 moments = Eigen::SelfAdjointEigenSolver<Mat3>(shape.inertia_per_mass).eigenvalues();
  return moments.maxCoeff() / moments.minCoeff();
}

struct Fall {
  double energy_gain = 0.0;  ///< greatest energy over that at the start
  double speed_at_end = 0.0, depth_at_end = 0.0;  ///< m/s of any point; m of the lowest point below the floor
};

/// Falls spinning onto a floor.
Fall fall_of(const std::shared_ptr<const Shape>& shape, double dt, std::uint32_t trial) {
  const MaterialTable materials = materials_of(0.3, 0.5);
  OdeWorld world({.gravity = {0, 0, -kCaseGravity}, .auto_disable = true}, materials);
  world.add_plane(Vec3::UnitZ(), 0.0, 0);
  RandomStream random(12, trial, 0);
  const RigidState start{.position = {0, 0, shape->radius + kDropHeight}, .orientation = random.orientation(), .velocity = random.direction(), .angular_velocity = 10.0 * random.direction()};
  const OdeBodyId body = world.add_body({.shape = shape, .state = start});
  const auto energy = [&] { return kinetic_energy(*shape, 1.0, world.state(body)) + kCaseGravity * world.state(body).position.z(); };
  const double first = energy();
  Fall fall;
  for (int i = 0; i < int(std::lround(kSeconds / dt)); ++i) {
    world.step(dt);
    fall.energy_gain = std::max(fall.energy_gain, energy() / first - 1.0);
  }
  const RigidState end = world.state(body);
  fall.speed_at_end = end.velocity.norm() + shape->radius * end.angular_velocity.norm();
  for (const Vec3& vertex : shape->hull.vertices) fall.depth_at_end = std::max(fall.depth_at_end, -(end.position + end.orientation * vertex).z());
  if (world.counters().states_recovered > 0) fall.energy_gain = std::nan("");
  return fall;
}

void add_rows(std::vector<HardCaseRow>& rows, const std::string& name, const std::shared_ptr<const Shape>& shape, double dt) {
  constexpr int kTrials = 20;
  Fall worst;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Fall fall = fall_of(shape, dt, trial);
    worst.energy_gain = std::max(worst.energy_gain, fall.energy_gain);
    worst.speed_at_end = std::max(worst.speed_at_end, fall.speed_at_end);
    worst.depth_at_end = std::max(worst.depth_at_end, fall.depth_at_end);
  }
  const std::string what = fmt::format("20 drops of a {}, dt {:.3g} s: ", name, dt);
  rows.push_back({.what = what + "energy gained", .value = worst.energy_gain, .bound = 0.01});
  rows.push_back({.what = what + "fastest point after 10 s", .value = worst.speed_at_end, .bound = 0.02, .unit = "m/s"});
  rows.push_back({.what = what + "depth in the floor after 10 s", .value = worst.depth_at_end, .bound = 1e-3, .unit = "m"});
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
    return "version: 1\nshapes: {crate: {box_m: [1, 1, 1], mass_kg: 1, inertia: " + diagonal + "}}\nground: [{plane: {normal: [0, 0, 1], offset_m: 0}}]\n"
           "bodies:\n  - {shape: crate, position_m: [0, 0, 1]}\n";
  };
  const std::string scenes[] = {scene_with("[[1, 0, 0], [0, 1, 0], [0, 0, 100]]"), scene_with("[[1, 0, 0], [0, 1, 0], [0, 0, -1]]"), scene_with("[[1, 2, 0], [2, 1, 0], [0, 0, 1]]"),
                                scene_with("[[0, 0, 0], [0, 0, 0], [0, 0, 0]]"), scene_with("[[.nan, 0, 0], [0, 1, 0], [0, 0, 1]]")};
  int wrong = count_unclear(scenes, "inertia") + !scene_error_of(scene_with("[[1, 0, 0], [0, 1, 0], [0, 0, 1.9]]")).empty();
  for (const Vec3& moments : {Vec3(1, 1, 100), Vec3(1, 1, -1), Vec3(0, 0, 0), Vec3(1, 1, std::nan(""))}) wrong += !is_refused(Mat3(moments.asDiagonal()));
  wrong += is_refused(Mat3(Vec3(1, 1, 1.9).asDiagonal()));
  return {.what = "inertias that no body has, (1, 1, 100) among them: accepted, or refused without a clear error", .value = double(wrong), .bound = 0.0};
}

}  // namespace

std::vector<HardCaseRow> measure_slender_bodies(const HardCaseSettings&) {
  const auto needle = share(make_shape("needle", make_needle(1.0, 0.0045)));
  const auto lath = box_of({1.0, 0.01, 0.001});
  std::vector<HardCaseRow> rows{impossible_inertias()};
  for (const double dt : {1e-3, 1.0 / 240, 1.0 / 60}) {
    add_rows(rows, fmt::format("needle, inertia ratio {:.3g}", largest_inertia_ratio(*needle)), needle, dt);
    add_rows(rows, fmt::format("plate, inertia ratio {:.3g}", largest_inertia_ratio(*lath)), lath, dt);
  }
  return rows;
}

}  // namespace lodestone
