#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/bench/body_cases.h"
#include "tools/bench/case_parts.h"

namespace lodestone {
namespace {

constexpr double kSeconds = 10.0;

struct Drift {
  double energy_gain = 0.0, energy_loss = 0.0, momentum_change = 0.0;  // each the greatest, relative to the start
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
    drift.energy_gain = std::max(drift.energy_gain, gain);
    drift.energy_loss = std::max(drift.energy_loss, -gain);
    drift.momentum_change = std::max(drift.momentum_change, (angular_momentum(*box, 1.0, state) - momentum).norm() / momentum.norm());
  }
  return drift;
}

}  // namespace

std::vector<HardCaseRow> measure_free_top(const HardCaseSettings&) {
  std::vector<HardCaseRow> rows;
  for (const int steps_per_s : {1000, 240, 60}) {
    const Drift drift = drift_of(1.0 / steps_per_s);
    const std::string what = fmt::format("box spinning freely near its middle axis, 10 rad/s, 10 s, dt 1/{} s: ", steps_per_s);
    rows.push_back({.what = what + "energy gained", .value = drift.energy_gain, .bound = 1e-9});
    rows.push_back({.what = what + "energy lost", .value = drift.energy_loss, .bound = 0.1});
    rows.push_back({.what = what + "change of angular momentum", .value = drift.momentum_change, .bound = 0.05});
  }
  return rows;
}

}  // namespace lodestone
