#include <fmt/format.h>

#include <algorithm>

#include "reference/random.h"
#include "tools/bench/case_parts.h"
#include "tools/bench/pair_cases.h"

namespace lodestone {
namespace {

constexpr double kSpeed = 200.0, kStep = 1.0 / 60, kRadius = 0.1, kThickness = 0.05, kWallSide = 4.0;
const Vec3 kWallSides{kThickness, kWallSide, kWallSide};

enum class Wall { box, mesh, body };

/// Flies at a wall across the x axis from the left, slanted by up to 45 degrees towards a place within its middle half. True where it ends up behind it.
bool tunnels(const std::shared_ptr<const Shape>& shape, Wall wall, std::uint32_t trial, std::int64_t& prevented) {
  const MaterialTable materials = materials_of(0.5, 0.5);
  OdeWorld world({.gravity = Vec3::Zero()}, materials);
  OdeBodyId wall_body;
  if (wall == Wall::box) world.add_static_box(kWallSides, Vec3::Zero(), Quat::Identity(), 0);
  if (wall == Wall::mesh) world.add_static_mesh(make_box(kWallSides), 0);
  if (wall == Wall::body) wall_body = world.add_body({.shape = box_of(kWallSides), .mass = 1000.0});

  RandomStream random(13, trial, 0);
  const Vec3 aim(0.0, random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
  const Vec3 direction = Vec3(1.0, random.uniform(-0.7, 0.7), random.uniform(-0.7, 0.7)).normalized();
  const RigidState start{.position = aim - random.uniform(2.0, 10.0) * direction, .orientation = random.orientation(), .velocity = kSpeed * direction, .angular_velocity = 10.0 * random.direction()};
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

/// Two equal balls fly at each other, at most 1.6 radii off the same line. True where neither changes its course.
bool miss_each_other(std::uint32_t trial, std::int64_t& prevented) {
  const MaterialTable materials = materials_of(0.5, 0.5);
  OdeWorld world({.gravity = Vec3::Zero()}, materials);
  const auto ball = ball_of(kRadius);
  RandomStream random(14, trial, 0);
  const Vec3 offset = random.uniform(0.0, 0.8) * kRadius * Vec3::UnitX().cross(random.direction()).normalized(), velocity = kSpeed * Vec3::UnitX();
  const double distance = random.uniform(1.0, 5.0);
  const OdeBodyId left = world.add_body({.shape = ball, .state = {.position = -distance * Vec3::UnitX() + offset, .velocity = velocity}});
  world.add_body({.shape = ball, .state = {.position = distance * Vec3::UnitX() - offset, .velocity = -velocity}});
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
  rows.push_back({.what = fmt::format("{} x {}, 200 m/s, dt 1/60 s: passed through", kTrials, what), .value = double(through), .bound = 0.0, .unit = "bodies"});
  rows.push_back({.what = fmt::format("{} x {}, 200 m/s, dt 1/60 s: passes prevented, counted", kTrials, what), .value = double(prevented), .bound = 0.5 * kTrials, .unit = "", .side = BoundSide::at_least});
}

}  // namespace

std::vector<HardCaseRow> measure_fast_bodies(const HardCaseSettings&) {
  const auto ball = ball_of(kRadius), cube = box_of(Vec3::Constant(2.0 * kRadius)), bunny = share(make_bunny_shape(2.0 * kRadius, 194));
  std::vector<HardCaseRow> rows;
  const auto at_wall = [&](const std::shared_ptr<const Shape>& shape, Wall wall) { return [=](int trial, std::int64_t& prevented) { return tunnels(shape, wall, trial, prevented); }; };
  add_rows(rows, "ball at a static wall of .05 m", at_wall(ball, Wall::box));
  add_rows(rows, "ball at a static mesh wall of .05 m", at_wall(ball, Wall::mesh));
  add_rows(rows, "ball at a free wall of .05 m", at_wall(ball, Wall::body));
  add_rows(rows, "trimesh cube at a static wall of .05 m", at_wall(cube, Wall::box));
  add_rows(rows, "trimesh cube at a free wall of .05 m", at_wall(cube, Wall::body));
  add_rows(rows, "bunny at a static mesh wall of .05 m", at_wall(bunny, Wall::mesh));
  add_rows(rows, "two balls at each other", miss_each_other);
  return rows;
}

}  // namespace lodestone
