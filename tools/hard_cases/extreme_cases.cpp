// F10, F13, F14: weights, speeds and places at which ODE's solver, its step or its arithmetic give out.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "reference/random.h"
#include "tools/hard_cases/case_parts.h"
#include "tools/hard_cases/hard_case.h"

namespace lodestone {
namespace {

// F10: a heavy cube on a light one: how far it sinks in.
namespace heavy_on_light {

constexpr double kSide = 0.2, kLightMass = 1.0, kSeconds = 10.0, kSettling = 1.0;

struct Sinking {
  double depth = 0.0;  ///< over the side, the deepest of the two contacts after the first second
  std::int64_t counted = 0;
};

Sinking sinking_of(double ratio, double dt, bool quick_step) {
  const MaterialTable materials = materials_of(0.0, 0.5);
  OdeWorld world({.gravity = {0, 0, -kCaseGravity}, .quick_step = quick_step}, materials);
  world.add_plane(Vec3::UnitZ(), 0.0, 0);
  const auto cube = box_of(Vec3::Constant(kSide));
  const OdeBodyId light =
      world.add_body({.shape = cube, .mass = kLightMass, .state = {.position = {0, 0, 0.5 * kSide}}});
  const OdeBodyId heavy = world.add_body(
      {.shape = cube, .mass = ratio * kLightMass, .state = {.position = {0.05 * kSide, 0, 1.5 * kSide}}});
  Sinking sinking;
  for (int i = 0; i < int(kSeconds / dt); ++i) {
    world.step(dt);
    if (i * dt < kSettling) continue;
    const double below = world.state(light).position.z(), above = world.state(heavy).position.z();
    sinking.depth = std::max({sinking.depth, 0.5 - below / kSide, 1.0 - (above - below) / kSide});
  }
  sinking.counted = world.counters().uneven_contacts;
  return sinking;
}

constexpr const char* kQuickStepYields =
    "QuickStep's iterations do not carry the weight through the light body. The full level steps with "
    "dWorldStep, which does, up to 150 contacts that hang "
    "together; beyond, full_uneven_contacts counts";

std::vector<HardCaseRow> measure_case(const HardCaseSettings& settings) {
  std::vector<HardCaseRow> rows;
  for (const int steps_per_s : {60, 240})
    for (const double ratio : {10.0, 100.0, 1e3, 1e4})
      rows.push_back(
          {.what = fmt::format("cube on one {:g} times lighter, 10 s, dt 1/{} s: penetration over side",
                               ratio, steps_per_s),
           .value = sinking_of(ratio, 1.0 / steps_per_s, false).depth,
           .bound = 0.02});
  for (const double ratio : settings.quick ? std::vector{1e3} : std::vector{1e3, 1e4}) {
    const std::string what = fmt::format("cube on one {:g} times lighter, QuickStep, dt 1/240 s: ", ratio);
    const Sinking sinking = sinking_of(ratio, 1.0 / 240, true);
    rows.push_back({.what = what + "penetration over side",
                    .value = sinking.depth,
                    .bound = 0.02,
                    .odes_own = kQuickStepYields});
    rows.push_back({.what = what + "uneven contacts counted",
                    .value = double(sinking.counted),
                    .bound = 1.0,
                    .side = BoundSide::at_least});
  }
  return rows;
}

}  // namespace heavy_on_light

// F13: bodies at 200 m/s against thin walls and each other: how many come out on the other side.
namespace fast_bodies {

constexpr double kSpeed = 200.0, kStep = 1.0 / 60, kRadius = 0.1, kThickness = 0.05, kWallSide = 4.0;
const Vec3 kWallSides{kThickness, kWallSide, kWallSide};

enum class Wall { box, mesh, body };

/// Flies at a wall across the x axis from the left, slanted by up to 45 degrees towards a place within its
/// middle half. True where it ends up behind it.
bool tunnels(const std::shared_ptr<const Shape>& shape, Wall wall, std::uint32_t trial,
             std::int64_t& prevented) {
  const MaterialTable materials = materials_of(0.5, 0.5);
  OdeWorld world({.gravity = Vec3::Zero()}, materials);
  OdeBodyId wall_body;
  if (wall == Wall::box) world.add_static_box(kWallSides, Vec3::Zero(), Quat::Identity(), 0);
  if (wall == Wall::mesh) world.add_static_mesh(make_box(kWallSides), 0);
  if (wall == Wall::body) wall_body = world.add_body({.shape = box_of(kWallSides), .mass = 1000.0});

  RandomStream random(13, trial, 0);
  const double aim_z = random.uniform(-1.0, 1.0), aim_y = random.uniform(-1.0, 1.0);
  const double z = random.uniform(-0.7, 0.7), y = random.uniform(-0.7, 0.7);
  const Vec3 aim(0.0, aim_y, aim_z), direction = Vec3(1.0, y, z).normalized();
  const RigidState start{.position = aim - random.uniform(2.0, 10.0) * direction,
                         .orientation = random.orientation(),
                         .velocity = kSpeed * direction,
                         .angular_velocity = 10.0 * random.direction()};
  const OdeBodyId body = world.add_body({.shape = shape, .mass = 1.0, .state = start});
  bool behind = false;
  for (int i = 0; i < 12 && !behind; ++i) {
    world.step(kStep);
    const double wall_place = wall_body ? world.state(wall_body).position.x() : 0.0;
    behind = world.state(body).position.x() > wall_place;
  }
  prevented += world.counters().passes_prevented;
  return behind;
}

/// Two equal balls fly at each other, at most 1.6 radii off the same line. True where neither changes its
/// course.
bool miss_each_other(std::uint32_t trial, std::int64_t& prevented) {
  const MaterialTable materials = materials_of(0.5, 0.5);
  OdeWorld world({.gravity = Vec3::Zero()}, materials);
  const auto ball = ball_of(kRadius);
  RandomStream random(14, trial, 0);
  const Vec3 aside = Vec3::UnitX().cross(random.direction()).normalized(),
             offset = random.uniform(0.0, 0.8) * kRadius * aside, velocity = kSpeed * Vec3::UnitX();
  const double distance = random.uniform(1.0, 5.0);
  const OdeBodyId left = world.add_body(
      {.shape = ball, .state = {.position = -distance * Vec3::UnitX() + offset, .velocity = velocity}});
  world.add_body(
      {.shape = ball, .state = {.position = distance * Vec3::UnitX() - offset, .velocity = -velocity}});
  for (int i = 0; i < 6; ++i) world.step(kStep);
  prevented += world.counters().passes_prevented;
  return (world.state(left).velocity - velocity).norm() < 1e-9;
}

template <typename Trial>
void add_rows(std::vector<HardCaseRow>& rows, const std::string& what, Trial trial) {
  constexpr int kTrials = 100;
  int through = 0;
  std::int64_t prevented = 0;
  for (int i = 0; i < kTrials; ++i) through += trial(i, prevented);
  const std::string set_up = fmt::format("{} x {}, 200 m/s, dt 1/60 s: ", kTrials, what);
  rows.push_back(
      {.what = set_up + "passed through", .value = double(through), .bound = 0.0, .unit = "bodies"});
  rows.push_back({.what = set_up + "passes prevented, counted",
                  .value = double(prevented),
                  .bound = 0.5 * kTrials,
                  .side = BoundSide::at_least});
}

std::vector<HardCaseRow> measure_case(const HardCaseSettings&) {
  const auto ball = ball_of(kRadius), cube = box_of(Vec3::Constant(2.0 * kRadius)),
             bunny = share(make_bunny_shape(2.0 * kRadius, 194));
  std::vector<HardCaseRow> rows;
  const auto at_wall = [&](const std::shared_ptr<const Shape>& shape, Wall wall) {
    return [=](int trial, std::int64_t& prevented) { return tunnels(shape, wall, trial, prevented); };
  };
  add_rows(rows, "ball at a static wall of .05 m", at_wall(ball, Wall::box));
  add_rows(rows, "ball at a static mesh wall of .05 m", at_wall(ball, Wall::mesh));
  add_rows(rows, "ball at a free wall of .05 m", at_wall(ball, Wall::body));
  add_rows(rows, "trimesh cube at a static wall of .05 m", at_wall(cube, Wall::box));
  add_rows(rows, "trimesh cube at a free wall of .05 m", at_wall(cube, Wall::body));
  add_rows(rows, "bunny at a static mesh wall of .05 m", at_wall(bunny, Wall::mesh));
  add_rows(rows, "two balls at each other", miss_each_other);
  return rows;
}

}  // namespace fast_bodies

// F14: a stack far from the origin, against the same at the origin.
namespace far_stacks {

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
    const double y = random.uniform(-0.03, 0.03) * kSide, x = random.uniform(-0.03, 0.03) * kSide;
    const Vec3 place(x, y, kSide * (0.5 + i + 1e-3 * (i + 1)));
    bodies.push_back(world.add_body(
        {.shape = cube, .mass = kMass, .state = {.position = origin + place, .orientation = turned}}));
  }
  for (int i = 0; i < int(std::lround(kSeconds / kStep)); ++i) world.step(kStep);
  std::vector<Vec3> ends;
  for (const OdeBodyId body : bodies) ends.push_back(world.state(body).position - origin);
  return ends;
}

double greatest_offset(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double greatest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) greatest = worse(greatest, (a[i] - b[i]).norm());
  return greatest;
}

std::vector<HardCaseRow> measure_case(const HardCaseSettings&) {
  const std::vector<Vec3> near = stack_at(Vec3::Zero());
  std::vector<HardCaseRow> rows;
  for (const double far : {1e3, 1e4, 1e5, 1e6, 1e7})
    rows.push_back(
        {.what = fmt::format(
             "stack of 5 trimesh cubes at {:g} m along each axis, 5 s: offset against the origin", far),
         .value = greatest_offset(near, stack_at(Vec3::Constant(far))),
         .bound = far < 1e7 ? 1e-5 : 1e-3,
         .unit = "m"});
  return rows;
}

}  // namespace far_stacks

}  // namespace

std::span<const HardCase> extreme_cases() {
  static constexpr std::array kCases = {
      HardCase{"F10", heavy_on_light::measure_case},
      HardCase{"F13", fast_bodies::measure_case},
      HardCase{"F14", far_stacks::measure_case},
  };
  return kCases;
}

}  // namespace lodestone
