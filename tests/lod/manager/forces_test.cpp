// Forces that go on, on bodies that touch something: they act through the step, and what they press together
// does not strike.
#include <gtest/gtest.h>
#include <ode/ode.h>

#include <algorithm>
#include <functional>
#include <numbers>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

constexpr double kCubeSide = 0.4, kMu = 0.6, kG = 9.81;  // m, –, m/s²
constexpr LevelChoice kPushedRungs[] = {LevelChoice::support, LevelChoice::tables};

Manager on_rough_floor() {
  Manager manager = on_floor({.signatures = coarse_signature});
  manager.materials().replace(0, {.restitution = 0.4, .friction = kMu});
  return manager;
}

/// Their forces in weights, by body.
void run_pushed(Manager& manager, std::span<const BodyId> bodies,
                const std::function<Vec3(std::size_t)>& push, double seconds) {
  for (int i = 0; i < int(seconds / kFrame); ++i) {
    for (std::size_t k = 0; k < bodies.size(); ++k)
      manager.add_force(bodies[k], push(k) * manager.mass(bodies[k]) * kG);
    manager.step(kFrame);
  }
}

TEST(Forces, WhatIsPressedToTheGroundLiesThere) {
  for (const LevelChoice level : kPushedRungs)
    for (const double down : {0.0, 1.0, 4.0}) {
      Manager manager = on_rough_floor();
      const BodyId cube = add(manager, box_shape({kCubeSide, kCubeSide, kCubeSide}),
                              testing::at({0, 0, 0.5 * kCubeSide}), level);
      run_pushed(
          manager, {&cube, 1}, [&](std::size_t) { return Vec3(0.5, 0, -down); }, 5.0);
      const RigidState end = manager.state(cube);
      EXPECT_LT(end.position.head<2>().norm(), 0.01) << int(level) << " under " << down;
      EXPECT_NEAR(end.position.z(), 0.5 * kCubeSide, 5e-4) << int(level) << " under " << down;
      EXPECT_LT(end.velocity.norm() + kCubeSide * end.angular_velocity.norm(), 0.01)
          << int(level) << " under " << down;
    }
}

TEST(Forces, WhatIsPressedToAWallHangsThere) {
  for (const LevelChoice level : kPushedRungs) {
    Manager manager = on_rough_floor();
    manager.add_plane(-Vec3::UnitX(), -0.5 * kCubeSide);
    const BodyId cube =
        add(manager, box_shape({kCubeSide, kCubeSide, kCubeSide}), testing::at({0, 0, 2}), level);
    run_pushed(
        manager, {&cube, 1}, [](std::size_t) { return Vec3(2, 0, 0); }, 5.0);
    EXPECT_NEAR(manager.state(cube).position.z(), 2.0, 0.02) << int(level);
  }
}

// By explicit Euler, which `support` once turned it by, it swings higher and higher.
TEST(Forces, ATorsionSpringWithDampingComesToRest) {
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables}) {
    Manager manager({.gravity = Vec3::Zero(), .signatures = coarse_signature});
    const BodyId plank = add(manager, box_shape({1.0, 0.3, 0.1}),
                             testing::at({0, 0, 2}, Vec3::Zero(), Vec3(0.3, 0, 0)), level);  // .017 rad
    const Mat3 inertia = manager.mass(plank) * manager.shape(plank).inertia_per_mass;
    for (int i = 0; i < 240; ++i) {
      const RigidState now = manager.state(plank);
      manager.add_force(plank, Vec3::Zero(),
                        -inertia * (600.0 * now.orientation.vec() + 4.0 * now.angular_velocity));
      manager.step(kFrame);
    }
    EXPECT_LT(manager.state(plank).angular_velocity.norm(), 0.2) << int(level);
  }
}

// What a full body is given as a force was not looked at where others near it were looked for.
TEST(Forces, WhatOneThrowsInAStepMeetsWhatIsInItsWay) {
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables})
    for (const LevelChoice other : {LevelChoice::support, LevelChoice::tables})
      for (const double speed : {90.0, 150.0}) {
        Manager manager({.gravity = Vec3::Zero(), .signatures = coarse_signature});
        const auto cube = box_shape({0.2, 0.2, 0.2});
        const BodyId thrown = add(manager, cube, testing::at({0, 0, 0}), level);
        const BodyId struck = manager.add_body(
            {.shape = cube, .state = testing::at({0.8, 0, 0}), .mass = 1000.0, .level = other});
        manager.step(kFrame);
        manager.add_force(thrown, Vec3(speed * manager.mass(thrown) / kFrame, 0, 0));
        for (int i = 0; i < 10; ++i) manager.step(kFrame);
        EXPECT_LT(manager.state(thrown).position.x(), 0.7) << int(level) << int(other) << speed;
        EXPECT_GT(manager.state(struck).velocity.x(), 0.1) << int(level) << int(other) << speed;
      }
}

TEST(Forces, AStackUnderAPressHolds) {
  Manager manager = on_rough_floor();
  std::vector<BodyId> stack;
  for (int i = 0; i < 3; ++i)
    stack.push_back(add(manager, box_shape({kCubeSide, kCubeSide, kCubeSide}),
                        testing::at({0, 0, (i + 0.5) * kCubeSide}), LevelChoice::support));
  run_pushed(
      manager, stack, [](std::size_t k) { return k == 2 ? Vec3(0.5, 0, -4) : Vec3(Vec3::Zero()); }, 5.0);
  for (int i = 0; i < 3; ++i) {
    const RigidState end = manager.state(stack[std::size_t(i)]);
    EXPECT_LT((end.position - Vec3(0, 0, (i + 0.5) * kCubeSide)).norm(), 0.005) << i;
    EXPECT_LT(end.velocity.norm() + kCubeSide * end.angular_velocity.norm(), 0.01) << i;
  }
}

// A world's gravity that its caller gives body by body.
TEST(Forces, AGravityOfItsOwnIsAsGoodAsTheWorlds) {
  Manager manager = on_rough_floor();
  std::vector<BodyId> bodies;
  for (int i = 0; i < 4; ++i)
    bodies.push_back(manager.add_body(
        {.shape = box_shape({kCubeSide, kCubeSide, kCubeSide}),
         .state = testing::at(i < 3 ? Vec3(0, 0, 0.1 + (i + 0.5) * kCubeSide) : Vec3(3, 0, 1.0)),
         .level = LevelChoice::support,
         .properties = {.gravity = false}}));
  run_pushed(
      manager, bodies, [](std::size_t) { return Vec3(0, 0, -1); }, 5.0);
  for (std::size_t i = 0; i < 4; ++i) {
    const RigidState end = manager.state(bodies[i]);
    EXPECT_NEAR(end.position.z(), (i < 3 ? double(i) + 0.5 : 0.5) * kCubeSide, 0.002) << i;
    EXPECT_LT(end.velocity.norm() + kCubeSide * end.angular_velocity.norm(), 0.02) << i;
  }
}

// What presses only holds: a torque too small to tip the cube leaves it where it is.
TEST(Forces, ATorqueTooSmallToTipLeavesItLying) {
  for (const LevelChoice level : kPushedRungs) {
    Manager manager = on_rough_floor();
    const BodyId cube = add(manager, box_shape({kCubeSide, kCubeSide, kCubeSide}),
                            testing::at({0, 0, 0.5 * kCubeSide}), level);
    const double tips = manager.mass(cube) * kG * 0.5 * kCubeSide;  // N m
    double fastest = 0.0;
    for (int i = 0; i < 300; ++i) {
      manager.add_force(cube, Vec3::Zero(), Vec3(0, 0.8 * tips, 0));
      manager.step(kFrame);
      if (i > 60) fastest = std::max(fastest, manager.state(cube).angular_velocity.norm());
    }
    EXPECT_LT(fastest, 0.05) << int(level);
    EXPECT_LT(manager.state(cube).position.head<2>().norm(), 0.01) << int(level);
  }
}

// At full, the diagonals of two squares cross in the middle: there, where nothing holds a turning, all of the
// weight was borne.
TEST(Forces, ATorqueThatFrictionHoldsTurnsNoStack) {
  constexpr double kSide = 0.3;
  for (const double of_bound : {0.25, 0.5}) {
    Manager manager = on_rough_floor();
    std::vector<BodyId> cubes;
    for (int i = 0; i < 5; ++i)
      cubes.push_back(add(manager, box_shape({kSide, kSide, kSide}), testing::at({0, 0, (i + 0.5) * kSide}),
                          LevelChoice::full));
    run(manager, 0.5);
    const double bound = kMu * manager.mass(cubes[4]) * kG * kSide / std::numbers::sqrt2;  // N m, at corners
    double turned = 0.0;
    for (int i = 0; i < 60; ++i) {
      manager.add_force(cubes[4], Vec3::Zero(), Vec3(0, 0, of_bound * bound));
      manager.step(kFrame);
    }
    for (const BodyId cube : cubes)
      turned = std::max(turned, manager.state(cube).orientation.angularDistance(Quat::Identity()));
    EXPECT_LT(turned, 0.05) << of_bound;
  }
}

// Friction opposes the slip that it would have without it, that of a torque too: along another way ODE's box
// of friction holds up to √2 times as much.
// It turned about its upright axis, and was held by √2 of friction, or by what a torque gives in a step; at
// full it went on as on rails, whose way turned aside.
TEST(Forces, APushHighUpMovesABoxAsOneLowDown) {
  struct Pushed {
    double side, height, friction, weights;  // m, m, –, –
  };
  for (const Pushed& box :
       {Pushed{0.3, 0.3, 0.2, 0.28}, {1.0, 1.0, 0.2, 0.28}, {0.3, 0.15, 0.4, 0.8}, {0.3, 0.45, 0.2, 0.23}})
    for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables}) {
      Manager manager = on_floor({.signatures = coarse_signature});
      manager.materials().replace(0, {.restitution = 0.0, .friction = box.friction});
      const BodyId body = add(manager, box_shape({box.side, box.side, box.height}),
                              testing::at({0, 0, 0.5 * box.height}), level);
      const Vec3 force(box.weights * manager.mass(body) * kG, 0, 0);
      manager.step(kFrame);
      constexpr int kFrames = 180;
      for (int i = 0; i < kFrames; ++i) {
        const RigidState now = manager.state(body);
        manager.add_force_at(body, force, now.position + now.orientation * Vec3(0, 0, 0.48 * box.height));
        manager.step(kFrame);
      }
      const double time = kFrames * kFrame, slid = 0.5 * (box.weights - box.friction) * kG * time * time;
      EXPECT_NEAR(manager.state(body).position.x(), slid, 0.05 * slid) << box.side << " m, " << int(level);
    }
}

TEST(Forces, ATorqueBeyondFrictionTurnsACubeAsCoulombSays) {
  constexpr double kSide = 0.3, kSeconds = 0.25;
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support}) {
    Manager manager = on_rough_floor();
    const BodyId cube =
        add(manager, box_shape({kSide, kSide, kSide}), testing::at({0, 0, 0.5 * kSide}), level);
    const double mass = manager.mass(cube), bound = kMu * mass * kG * kSide / std::numbers::sqrt2;
    const auto turn_with = [&](double of_bound) {
      for (int i = 0; i < int(kSeconds / kFrame); ++i) {
        manager.add_force(cube, Vec3::Zero(), Vec3(0, 0, of_bound * bound));
        manager.step(kFrame);
      }
      return manager.state(cube).angular_velocity.z();
    };
    run(manager, 0.2);
    EXPECT_NEAR(turn_with(0.95), 0.0, 1e-3) << int(level);
    const double moment = mass * kSide * kSide / 6.0, expected = 0.2 * bound / moment * kSeconds;
    EXPECT_NEAR(turn_with(1.2), expected, 0.1 * expected) << int(level);
  }
}

// Two layers on a full sled, which all slept: who lies on the first one was laid down again in each substep.
TEST(Forces, ASledStartsUnderAStackThatSlept) {
  for (const int layers : {1, 2, 4}) {
    Manager manager = on_rough_floor();
    const BodyId sled = manager.add_body({.shape = box_shape({3, 1.5, 0.2}),
                                          .state = testing::at({0, 0, 0.1}),
                                          .mass = 50.0,
                                          .level = LevelChoice::full});
    for (int i = 0; i < layers; ++i)
      manager.add_body({.shape = box_shape({0.5, 0.5, 0.15}),
                        .state = testing::at({0.005 * (i % 2), 0, 0.2 + 0.15 * (i + 0.5)}),
                        .mass = 20.0,
                        .level = LevelChoice::full});
    run(manager, 2.0);
    EXPECT_EQ(manager.report().asleep, layers + 1);
    constexpr double kExcess = 1.0;  // m/s²
    for (int i = 0; i < 60; ++i) {
      manager.add_force(sled, {(50.0 + 20.0 * layers) * (kMu * kG + kExcess), 0, 0});
      manager.step(kFrame);
    }
    EXPECT_NEAR(manager.state(sled).position.x(), 0.5 * kExcess, 0.05) << layers;
  }
}

/// m/s: a board of 20 kg and a cube of 5 kg on it, after the board was drawn for a second with what gives
/// both `pull` m/s².
struct Drawn {
  double board = 0.0, load = 0.0;
};

Drawn draw_a_board(LevelChoice level, double pull, double dt, double rest) {
  Manager manager = on_rough_floor();
  const auto add_at = [&](const Vec3& sides, double height, double mass) {
    return manager.add_body({.shape = box_shape(sides),
                             .state = testing::at({0.02, 0.01, height}),
                             .mass = mass,
                             .level = level});
  };
  const BodyId board = add_at({1, 1, 0.1}, 0.05, 20.0), load = add_at({0.3, 0.3, 0.3}, 0.25, 5.0);
  for (double t = 0.0; t < rest; t += dt) manager.step(dt);
  for (double t = 0.0; t < 1.0 - 0.5 * dt; t += dt) {
    manager.add_force(board, {25.0 * (pull + kMu * kG), 0, 0});
    manager.step(dt);
  }
  return {manager.state(board).velocity.x(), manager.state(load).velocity.x()};
}

// At any rate: of a force little passes in a short substep, and a sleeper that stands like ground would hold
// it for ever.
TEST(Forces, ASleeperGoesWithTheBoardThatIsDrawnUnderIt) {
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support})
    for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 144, 1.0 / 240}) {
      const double pull = 1.0;
      const Drawn drawn = draw_a_board(level, pull, dt, 2.0);
      EXPECT_NEAR(drawn.board, pull, 0.05 * pull) << dt;
      EXPECT_NEAR(drawn.load, pull, 0.05 * pull) << dt;
    }
}

// A ball that is spun on a board asleep on ice pushes it back as it rolls off: no momentum comes from
// nowhere.
TEST(Forces, ABallSpunOnASleepingBoardPushesItBack) {
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support})
    for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 240}) {
      ManagerSettings settings = unmeasured();
      Manager manager(settings);
      const MaterialId ice = manager.materials().add({.restitution = 0.2, .friction = 0.0});
      manager.add_plane(Vec3::UnitZ(), 0.0, ice);
      const auto add_at = [&](const std::shared_ptr<const Shape>& shape, double height, double mass) {
        return manager.add_body(
            {.shape = shape, .state = testing::at({0, 0, height}), .mass = mass, .level = level});
      };
      const BodyId board = add_at(box_shape({4, 1, 0.1}), 0.05, 5.0),
                   ball = add_at(std::make_shared<const Shape>(make_sphere_shape(0.2)), 0.3, 8.0);
      for (double t = 0.0; t < 2.0; t += dt) manager.step(dt);
      ASSERT_TRUE(manager.asleep(board) && manager.asleep(ball));
      for (double t = 0.0; t < 0.5; t += dt) {
        manager.add_force(ball, Vec3::Zero(), {0, 3.2, 0});
        manager.step(dt);
      }
      const double forth = 8.0 * manager.state(ball).velocity.x(),
                   back = 5.0 * manager.state(board).velocity.x();
      EXPECT_GT(forth, 3.0) << dt;
      EXPECT_NEAR(forth, -back, 0.02 * forth) << dt;
    }
}

// At `tables`, too.
TEST(Forces, ABoardAtTablesTakesItsLoadAlong) {
  for (const double rest : {0.1, 2.0})
    for (const double pull : {1.0, 2.5}) {
      const Drawn drawn = draw_a_board(LevelChoice::tables, pull, 1.0 / 60, rest);
      EXPECT_NEAR(drawn.board, pull, 0.05 * pull) << rest;
      EXPECT_NEAR(drawn.load, pull, 0.05 * pull) << rest;
    }
}

// A row and a stack, pushed by the first for two seconds: nothing holds them, however weak that is.
// A force that ODE itself is given in each frame, on a full body that falls asleep meanwhile and wakes again.
TEST(Forces, WhatIsGivenThroughODEIsGivenOnce) {
  for (const Vec3& push : {Vec3(0.4, 0, 0), Vec3(0, 0, 0.7)}) {  // over the weight
    Manager manager({.signatures = coarse_signature});
    manager.materials().replace(0, {.restitution = 0.0, .friction = 0.5});
    manager.add_plane(Vec3::UnitZ(), 0.0);
    const BodyId cube = add(manager, box_shape({kCubeSide, kCubeSide, kCubeSide}),
                            testing::at({0, 0, 0.5 * kCubeSide}), LevelChoice::full);
    const Vec3 force = manager.mass(cube) * kG * push;
    double fastest = 0.0;  // m/s
    for (int frame = 0; frame < 5 * 60; ++frame) {
      dBodyAddForce(manager.ode_body(cube), force.x(), force.y(), force.z());
      manager.step(kFrame);
      fastest = std::max(fastest, manager.state(cube).velocity.norm());
    }
    EXPECT_LT(fastest, 0.01) << push.transpose();
  }
}

TEST(Forces, AWeakPushOnIceMovesAllThatTouch) {
  constexpr int kCubes = 3;
  for (const LevelChoice level : kPushedRungs)
    for (const bool stacked : {false, true})
      for (const double push : {0.02, 0.05, 0.3}) {  // over the weight of all
        Manager manager({.signatures = coarse_signature});
        manager.materials().replace(0, {.restitution = 0.0, .friction = 0.5});
        const MaterialId ice = manager.materials().add({.restitution = 0.0, .friction = 0.0});
        manager.add_plane(Vec3::UnitZ(), 0.0, ice);
        const auto box = box_shape({kCubeSide, kCubeSide, kCubeSide});
        std::vector<BodyId> cubes;
        for (int i = 0; i < kCubes; ++i)
          cubes.push_back(add(manager, box,
                              testing::at(Vec3(0, 0, 0.5 * kCubeSide) +
                                          i * kCubeSide * (stacked ? Vec3::UnitZ() : Vec3::UnitX())),
                              level));
        run(manager, 1.0);
        run_pushed(
            manager, std::span(cubes).first(1), [&](std::size_t) { return Vec3(kCubes * push, 0, 0); }, 2.0);
        double mean = 0.0;
        for (const BodyId cube : cubes) mean += manager.state(cube).velocity.x() / kCubes;
        const double expected = push * kG * 2.0;
        EXPECT_NEAR(mean, expected, 0.03 * expected)
            << int(level) << (stacked ? " stack, " : " row, ") << push;
      }
}

// Without a pull nothing is pressed on: restitution is what it is, whenever in a step a body strikes.
TEST(Forces, ABodyWithoutGravityReboundsAsItShould) {
  for (int phase = 0; phase < 12; ++phase) {
    Manager manager({.sleeping = false});
    manager.materials().replace(0, {.restitution = 0.4, .friction = 0.5});
    manager.add_plane(Vec3::UnitZ(), 0.0);
    const BodyId body = manager.add_body({.shape = testing::box_shape({0.2, 0.2, 0.2}),
                                          .state = testing::at({0, 0, 0.5 + 0.004 * phase}, {0, 0, -3}),
                                          .level = LevelChoice::full,
                                          .properties = {.gravity = false}});
    testing::run(manager, 0.4);
    EXPECT_NEAR(manager.state(body).velocity.z(), 1.2, 1e-6) << phase;
  }
}

// Two that touch, without gravity of their own or held up by a force: the step's fall, which they do not
// have, is not taken from their rebound.
TEST(Forces, WhoDoesNotFallBouncesAsItCame) {
  constexpr double kDown = 0.5, kBall = 0.2;  // m/s, m
  const auto ball = std::make_shared<const Shape>(make_sphere_shape(kBall));
  for (const bool by_force : {false, true}) {
    Manager manager = on_floor();
    manager.materials().replace(0, {.restitution = 0.8, .friction = 0.0});
    std::vector<BodyId> balls;
    for (int i = 0; i < 2; ++i)
      balls.push_back(manager.add_body({.shape = ball,
                                        .state = testing::at({0.401 * i, 0, 0.5}, {0, 0, -kDown}),
                                        .level = LevelChoice::support,
                                        .properties = {.gravity = by_force}}));
    for (int step = 0; step < 60; ++step) {
      for (const BodyId body : balls)
        if (by_force) manager.add_force(body, Vec3(0, 0, kGravity * manager.mass(body)));
      manager.step(kFrame);
    }
    for (const BodyId body : balls)
      EXPECT_NEAR(manager.state(body).velocity.z(), 0.8 * kDown, 0.01) << by_force;
  }
}

}  // namespace
}  // namespace lodestone
