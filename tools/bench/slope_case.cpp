#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "tools/bench/body_cases.h"
#include "tools/bench/case_parts.h"

namespace lodestone {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0, kTilt = 25 * kDegree, kSeconds = 2.0, kStep = 1e-3;
constexpr double kMostCreep = 2e-3;  // m/s

double speed_after(double friction, double azimuth_deg) {
  const MaterialTable materials = materials_of(0.0, friction);
  OdeWorld world({.gravity = {0, 0, -kCaseGravity}}, materials);
  const Quat turn = Quat(Eigen::AngleAxisd(azimuth_deg * kDegree, Vec3::UnitZ())) * Quat(Eigen::AngleAxisd(kTilt, Vec3::UnitY()));
  const Vec3 normal = turn * Vec3::UnitZ();
  world.add_plane(normal, 0.0, 0);
  // The box's own sides stay along x and y as far as the slope lets them.
  const RigidState start{.position = 0.1 * normal, .orientation = Quat::FromTwoVectors(Vec3::UnitZ(), normal)};
  const OdeBodyId box = world.add_body({.shape = box_of({0.4, 0.4, 0.2}), .state = start});
  for (int i = 0; i < int(std::lround(kSeconds / kStep)); ++i) world.step(kStep);
  return world.state(box).velocity.norm();
}

HardCaseRow row_of(double friction, double azimuth_deg) {
  const double speed = speed_after(friction, azimuth_deg);
  const double expected = kCaseGravity * (std::sin(kTilt) - friction * std::cos(kTilt)) * kSeconds;
  const std::string what = fmt::format("box on a slope of 25 deg towards {:g} deg, friction {:g}", azimuth_deg, friction);
  if (expected > 0.0) return {.what = what + ": error of its speed after 2 s", .value = std::abs(speed / expected - 1.0), .bound = 0.05};
  return {.what = what + ": creep after 2 s", .value = speed, .bound = kMostCreep, .unit = "m/s"};
}

}  // namespace

std::vector<HardCaseRow> measure_slopes(const HardCaseSettings&) {
  std::vector<HardCaseRow> rows;
  for (const double friction : {0.45, 0.48, 0.55})
    for (const double azimuth_deg : {0.0, 22.5, 45.0}) rows.push_back(row_of(friction, azimuth_deg));
  return rows;
}

}  // namespace lodestone
