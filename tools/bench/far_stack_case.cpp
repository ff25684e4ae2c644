#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reference/random.h"
#include "tools/bench/case_parts.h"
#include "tools/bench/pair_cases.h"

namespace lodestone {
namespace {

constexpr int kCubes = 5;
constexpr double kSide = 0.5, kMass = 125.0, kSeconds = 5.0, kStep = 1.0 / 60;

/// Where the cubes of a stack about `origin` end, from there.
std::vector<Vec3> stack_at(const Vec3& origin) {
  const MaterialTable materials = materials_of(0.0, 0.5);
  OdeWorld world({.gravity = {0, 0, -kCaseGravity}}, materials);
  world.add_plane(Vec3::UnitZ(), origin.z(), 0);
  const auto cube = box_of(Vec3::Constant(kSide));
  std::vector<OdeBodyId> bodies;
  for (int i = 0; i < kCubes; ++i) {
    RandomStream random(14, i, 0);
    const Quat turned(Eigen::AngleAxisd(random.uniform(-0.3, 0.3), Vec3::UnitZ()));
    const Vec3 place(random.uniform(-0.03, 0.03) * kSide, random.uniform(-0.03, 0.03) * kSide, kSide * (0.5 + i + 1e-3 * (i + 1)));
    bodies.push_back(world.add_body({.shape = cube, .mass = kMass, .state = {.position = origin + place, .orientation = turned}}));
  }
  for (int i = 0; i < int(std::lround(kSeconds / kStep)); ++i) world.step(kStep);
  std::vector<Vec3> ends;
  for (const OdeBodyId body : bodies) ends.push_back(world.state(body).position - origin);
  return ends;
}

double greatest_offset(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double greatest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) greatest = std::max(greatest, (a[i] - b[i]).norm());
  return greatest;
}

}  // namespace

std::vector<HardCaseRow> measure_far_stacks(const HardCaseSettings&) {
  const std::vector<Vec3> near = stack_at(Vec3::Zero());
  std::vector<HardCaseRow> rows;
  for (const double far : {1e3, 1e4, 1e5, 1e6, 1e7})
    rows.push_back({.what = fmt::format("stack of 5 trimesh cubes at {:g} m along each axis, 5 s: offset against the origin", far),
                    .value = greatest_offset(near, stack_at(Vec3::Constant(far))),
                    .bound = far < 1e7 ? 1e-5 : 1e-3,
                    .unit = "m"});
  return rows;
}

}  // namespace lodestone
