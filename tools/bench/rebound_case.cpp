#include <fmt/format.h>

#include <algorithm>

#include "tools/bench/body_cases.h"
#include "tools/bench/case_parts.h"

namespace lodestone {
namespace {

constexpr int kHeights = 20;
constexpr double kLowest = 0.9, kHighest = 1.1, kRadius = 0.1, kRestitution = 0.5;
constexpr double kIdeal = kRestitution * kRestitution;

/// Rebound over drop height.
double rebound_from(double height, double dt) {
  const MaterialTable materials = materials_of(kRestitution, 0.0);
  OdeWorld world({.gravity = {0, 0, -kCaseGravity}}, materials);
  world.add_plane(Vec3::UnitZ(), 0.0, 0);
  const OdeBodyId ball = world.add_body({.shape = ball_of(kRadius), .state = {.position = {0, 0, kRadius + height}}});
  const auto speed = [&] { return world.state(ball).velocity.z(); };
  for (int i = 0; i < int(2.0 / dt) && speed() <= 0.0; ++i) world.step(dt);
  double top = 0.0;
  for (; speed() > 0.0; world.step(dt)) top = std::max(top, world.state(ball).position.z());
  return (top - kRadius) / height;
}

struct Band {
  int steps_per_s;
  double below, above;  // of the ideal
};

}  // namespace

std::vector<HardCaseRow> measure_rebounds(const HardCaseSettings&) {
  std::vector<HardCaseRow> rows;
  for (const auto& [steps_per_s, below, above] : {Band{1000, 0.06, 0.06}, {500, 0.06, 0.06}, {240, 0.06, 0.06}, {120, 0.10, 0.06}, {60, 0.18, 0.04}}) {
    std::vector<double> rebounds;
    for (int i = 0; i < kHeights; ++i) rebounds.push_back(rebound_from(kLowest + (kHighest - kLowest) * i / (kHeights - 1), 1.0 / steps_per_s));
    const std::string what = fmt::format("ball dropped from 20 heights, e .5, dt 1/{} s: ", steps_per_s);
    rows.push_back({.what = what + "highest rebound over drop", .value = std::ranges::max(rebounds), .bound = kIdeal * (1.0 + above)});
    rows.push_back({.what = what + "lowest rebound over drop", .value = std::ranges::min(rebounds), .bound = kIdeal * (1.0 - below), .side = BoundSide::at_least});
  }
  return rows;
}

}  // namespace lodestone
