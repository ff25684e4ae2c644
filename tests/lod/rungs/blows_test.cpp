// A sleeper holds like ground; what strikes a row of them must move it all the same, whichever rungs they are
// on.
#include "lod/rungs/blows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

constexpr double kCube = 0.3, kLight = 5.0, kHeavy = 20.0;    // m, kg
constexpr double kFriction = 0.4, kSpeed = 3.0, kWay = 0.05;  // m/s; m, before it strikes
constexpr int kRow = 5;

struct StruckRow {
  Manager manager = on_floor({.full_substeps = 8, .signatures = coarse_signature});
  std::vector<BodyId> row;
  BodyId striker;

  StruckRow(LevelChoice striker_level, LevelChoice even, LevelChoice odd) {
    manager.materials().replace(0, {.restitution = 0.0, .friction = kFriction});
    const auto cube = box_shape({kCube, kCube, kCube});
    const auto add = [&](double x, double mass, LevelChoice level) {
      return manager.add_body(
          {.shape = cube, .state = testing::at({x, 0, kCube / 2}), .mass = mass, .level = level});
    };
    for (int i = 0; i < kRow; ++i) row.push_back(add((kCube + 1e-3) * i, kLight, i % 2 == 0 ? even : odd));
    striker = add(-kCube - kWay, kHeavy, striker_level);
    run(manager, 1.5);
    for (const BodyId body : row) EXPECT_TRUE(manager.asleep(body));
    RigidState state = manager.state(striker);
    state.velocity = Vec3(kSpeed, 0, 0);
    manager.set_state(striker, state);
  }
  double momentum() const {  // N s
    double sum = kHeavy * manager.state(striker).velocity.x();
    for (const BodyId body : row) sum += kLight * manager.state(body).velocity.x();
    return sum;
  }
};

TEST(Blows, ARowOfSleepersTakesTheMomentumOfWhatStrikesIt) {
  constexpr LevelChoice kLevels[] = {LevelChoice::full, LevelChoice::support, LevelChoice::tables};
  for (const LevelChoice striker : kLevels)
    for (const LevelChoice even : kLevels)
      for (const LevelChoice odd : kLevels) {
        StruckRow on(striker, even, odd);
        constexpr double kTime = 0.1;  // s: by then it has gone through the row
        run(on.manager, kTime);
        const double all = kHeavy + kRow * kLight,
                     most_braked = kFriction * 9.81 * all * kTime;  // N s, if all slid from the start
        SCOPED_TRACE(std::to_string(int(striker)) + " on " + std::to_string(int(even)) + ", " +
                     std::to_string(int(odd)));
        EXPECT_GT(on.momentum(), kHeavy * kSpeed - 1.3 * most_braked);
        EXPECT_GT(on.manager.state(on.row.back()).velocity.x(), 0.3 * kSpeed);
      }
}

// What only leans on them does not wake them.
// What is near-still among others was brought to a stop whatever friction there is: of two cubes on ice half
// of the momentum was left after a quarter of a second.
// Of two cubes, and of a row of six that overlap by a hair once they have struck.
TEST(Blows, OnIceMomentumLasts) {
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables})
    for (const int cubes : {2, 6}) {
      Manager manager = on_floor({.full_substeps = 8, .signatures = coarse_signature});
      manager.materials().replace(0, {.restitution = 0.2, .friction = 0.0});
      const auto cube = box_shape({0.4, 0.4, 0.4});
      std::vector<BodyId> row;
      for (int i = 0; i < cubes; ++i)
        row.push_back(add(manager, cube, testing::at({0.401 * i, 0, 0.2}), level));
      run(manager, 1.5);
      RigidState state = manager.state(row[0]);
      state.velocity = Vec3(1, 0, 0);
      manager.set_state(row[0], state);
      run(manager, 0.4);
      double left = 0.0;
      for (const BodyId body : row) left += manager.state(body).velocity.x();
      EXPECT_NEAR(left, 1.0, 0.02) << int(level) << ", " << cubes;
    }
}

TEST(Blows, ARowThatIsTouchedGentlySleepsOn) {
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables}) {
    StruckRow on(level, level, level);
    RigidState state = on.manager.state(on.striker);
    state.position.x() = -kCube - 0.005;
    state.velocity.x() = 0.05;
    on.manager.set_state(on.striker, state);
    for (int i = 0; i < 60; ++i) {
      on.manager.step(kFrame);
      for (std::size_t k = 1; k < on.row.size(); ++k) ASSERT_TRUE(on.manager.asleep(on.row[k])) << k;
    }
  }
}

// Who sleeps on top would hold it as in a vice, between itself and the ground. ODE takes 190 N s in 240 Hz.
TEST(Blows, AStackOfSleepersIsNoVice) {
  constexpr double kSide = 0.4, kStrikerSide = 0.3, kStriker = 40.0, kFast = 6.0;  // m, kg, m/s
  Manager manager = on_floor();
  manager.materials().replace(0, {.restitution = 0.4, .friction = 0.5});
  std::vector<BodyId> stack;
  for (int i = 0; i < 4; ++i)
    stack.push_back(add(manager, box_shape({kSide, kSide, kSide}),
                        testing::at({0, 0, kSide * (i + 0.5) + 1e-3 * i}), LevelChoice::support));
  run(manager, 1.0);
  for (const BodyId body : stack) ASSERT_TRUE(manager.asleep(body));
  manager.add_body({.shape = box_shape({kStrikerSide, kStrikerSide, kStrikerSide}),
                    .state = testing::at({-1.5, 0.07, 0.7}, {kFast, 0, 0.5}),
                    .mass = kStriker,
                    .level = LevelChoice::support});
  double most = 0.0;  // N s
  for (int i = 0; i < 60; ++i) {
    manager.step(kFrame);
    double sum = 0.0;
    for (const BodyId body : stack) sum += manager.mass(body) * manager.state(body).velocity.x();
    most = std::max(most, sum);
  }
  EXPECT_GT(most, 0.6 * kStriker * kFast);
  EXPECT_GT(manager.state(stack[1]).position.x(), 0.15);
}

// ODE (dWorldStep at 1/960 s): it leaves the stack at 1.66 m/s, straight up, and the stack stands as it
// stood.
TEST(Blows, ABoxThatFallsOnAStackBouncesOffItAndLeavesItStanding) {
  constexpr double kSide = 0.4, kHeavySide = 0.5, kDensity = 300.0, kDown = 3.0;  // m, kg/m³, m/s
  for (const bool asleep : {false, true}) {
    Manager manager = on_floor();
    manager.materials().replace(0, {.restitution = 0.3, .friction = 0.5, .density = kDensity});
    std::vector<BodyId> stack;
    for (int i = 0; i < 4; ++i)
      stack.push_back(add(manager, box_shape({kSide, kSide, kSide}), testing::at({0, 0, kSide * (i + 0.5)}),
                          LevelChoice::support));
    if (asleep) run(manager, 1.5);
    const BodyId striker = add(manager, box_shape({kHeavySide, kHeavySide, kHeavySide}),
                               testing::at({0.1, 0.05, 4 * kSide + kHeavySide / 2 + 1.35}, {0, 0, -kDown}),
                               LevelChoice::support);
    double fastest = 0.0, aside = 0.0, stirs = 0.0;  // m/s
    for (int i = 0; i < 40; ++i) {
      manager.step(kFrame);
      const Vec3 leaves = manager.state(striker).velocity;
      fastest = std::max(fastest, leaves.z()), aside = std::max(aside, leaves.head<2>().norm());
      for (const BodyId body : stack) stirs = std::max(stirs, manager.state(body).velocity.norm());
    }
    EXPECT_NEAR(fastest, 1.65, 0.1) << asleep;
    EXPECT_LT(aside, 0.1) << asleep;
    EXPECT_LT(stirs, 0.15) << asleep;
    run(manager, 4.0);
    for (int i = 0; i < 4; ++i)
      EXPECT_LT((manager.state(stack[std::size_t(i)]).position - Vec3(0, 0, kSide * (i + 0.5))).norm(), 0.01)
          << i << ", " << asleep;
  }
}

}  // namespace
}  // namespace lodestone
