// Stacks whose bodies are on different rungs stand as those of one rung do.
#include <gtest/gtest.h>
#include <ode/ode.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "reference/random.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

constexpr double kStackedSide = 0.3, kSetDown = 0.02, kAsideBy = 0.02;  // m

LevelChoice level_of(char letter) {
  return letter == 'f' ? LevelChoice::full : letter == 's' ? LevelChoice::support : LevelChoice::tables;
}

/// Set down from a little above, each a little aside of the one below: from below, a letter a cube.
std::vector<BodyId> add_stack(Manager& manager, const std::string& levels, std::uint32_t seed) {
  RandomStream random(seed, 0, 0);
  const auto cube = box_shape({kStackedSide, kStackedSide, kStackedSide});
  std::vector<BodyId> cubes;
  for (std::size_t i = 0; i < levels.size(); ++i)
    cubes.push_back(add(manager, cube,
                        testing::at({random.uniform(-kAsideBy, kAsideBy), random.uniform(-kAsideBy, kAsideBy),
                                     kStackedSide * (double(i) + 0.5) + kSetDown + 0.01 * double(i)}),
                        level_of(levels[i])));
  return cubes;
}

void expect_stands(const Manager& manager, const std::vector<BodyId>& cubes, const std::string& levels) {
  for (std::size_t i = 0; i < cubes.size(); ++i) {
    EXPECT_NEAR(manager.state(cubes[i]).position.z(), kStackedSide * (double(i) + 0.5), 0.03)
        << levels << ", cube " << i;
    EXPECT_TRUE(manager.asleep(cubes[i])) << levels << ", cube " << i;
  }
}

/// A full box that nothing pushes.
BodyId add_kinematic(Manager& manager, const Vec3& sides, const Vec3& position) {
  return manager.add_body({.shape = box_shape(sides),
                           .state = testing::at(position),
                           .level = LevelChoice::full,
                           .properties = {.kinematic = true}});
}

TEST(MixedStacks, Stand) {
  for (const std::string levels : {"fs", "ft", "sf", "tf", "fsfs", "sfsf", "ftft", "tftf", "sfff", "fsst"})
    for (const double restitution : {0.0, 0.4})
      for (const int substeps : {4, 16}) {
        Manager manager = on_floor({.full_substeps = substeps, .signatures = coarse_signature});
        manager.materials().replace(0, {.restitution = restitution, .friction = 0.5});
        const std::vector<BodyId> cubes = add_stack(manager, levels, 1);
        run(manager, 5.0);
        SCOPED_TRACE("e " + std::to_string(restitution) + ", " + std::to_string(substeps) + " substeps");
        expect_stands(manager, cubes, levels);
      }
}

// Who steps his world himself does so once, whatever full_substeps says.
TEST(MixedStacks, StandInACallersLoop) {
  for (const std::string levels : {"sfsf", "tftf", "fsst"}) {
    dInitODE2(0);
    dAllocateODEDataForThread(dAllocateMaskAll);
    const dWorldID world = dWorldCreate();
    const dSpaceID space = dHashSpaceCreate(nullptr);
    dWorldSetGravity(world, 0, 0, -kGravity);
    dCreatePlane(space, 0, 0, 1, 0);
    {
      Manager manager(world, space, {.full_substeps = 4, .signatures = coarse_signature});
      manager.materials().replace(0, {.restitution = 0.2, .friction = 0.5});
      const std::vector<BodyId> cubes = add_stack(manager, levels, 2);
      for (int i = 0; i < 300; ++i) {
        manager.before_world_step(kFrame);
        dWorldStep(world, kFrame);
        manager.after_world_step();
      }
      expect_stands(manager, cubes, levels);
    }
    dSpaceDestroy(space);
    dWorldDestroy(world);
  }
}

TEST(MixedStacks, WhatIsAddedInsideOthersPartsFromThem) {
  Manager manager = on_floor({.signatures = coarse_signature});
  const auto cube = box_shape({kStackedSide, kStackedSide, kStackedSide});
  std::vector<BodyId> cubes;
  for (int i = 0; i < 8; ++i) {  // each before the last one has fallen away
    cubes.push_back(add(manager, cube, testing::at({0, 0, 1}), LevelChoice::support));
    for (int k = 0; k < 10; ++k) manager.step(kFrame);
  }
  run(manager, 8.0);
  std::vector<double> heights;
  for (const BodyId body : cubes) heights.push_back(manager.state(body).position.z());
  std::ranges::sort(heights);
  for (std::size_t i = 1; i < heights.size(); ++i)
    EXPECT_TRUE(heights[i] - heights[i - 1] > 0.8 * kStackedSide || heights[i] - heights[i - 1] < 0.01) << i;
}

// What touches, and is slow where it turns back, is still on its way.
TEST(MixedStacks, WhatFallsTogetherDoesNotComeToRestInTheAir) {
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables})
    for (const auto& [gravity, frame] : {std::pair{9.81, 1.0 / 30}, {1.62, 1.0 / 30}, {1.62, 1.0 / 60}}) {
      Manager manager = on_floor({.signatures = coarse_signature});
      manager.set_gravity({0, 0, -gravity});
      std::vector<BodyId> cubes;
      const double speed = 2.0;
      for (int i = 0; i < 8; ++i) {
        RigidState state = testing::at({0.301 * (i % 2), 0.301 * (i / 2 % 2), 1.0 + 0.301 * (i / 4)});
        state.velocity.z() = speed;
        cubes.push_back(add(manager, box_shape({kStackedSide, kStackedSide, kStackedSide}), state, level));
      }
      const int frames = int(2.0 * speed / gravity / frame);  // until it is back where it began
      for (int i = 0; i < frames; ++i) {
        manager.step(frame);
        for (const BodyId body : cubes) ASSERT_FALSE(manager.asleep(body)) << int(level) << " in frame " << i;
      }
      for (const BodyId body : cubes)
        EXPECT_NEAR(manager.state(body).velocity.z(), speed - gravity * frames * frame, 0.1 * speed)
            << int(level) << " at " << gravity << " m/s², steps of " << frame << " s";
    }
}

// A wall carries nobody.
TEST(MixedStacks, WhatTouchesAWallAndLosesItsGroundFalls) {
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables})
    for (const double gravity : {9.81, 1.62}) {
      Manager manager = on_floor({.signatures = coarse_signature});
      manager.set_gravity({0, 0, -gravity});
      manager.add_plane(Vec3::UnitX(), 0.0);
      const GroundId shelf = manager.add_static_box({1, 1, 0.1}, {0.5, 0, 4.95}, Quat::Identity());
      std::vector<BodyId> cubes;
      for (int i = 0; i < 9; ++i)
        cubes.push_back(
            add(manager, box_shape({kStackedSide, kStackedSide, kStackedSide}),
                testing::at({kStackedSide * (i % 3 + 0.5), 0, 5.0 + kStackedSide * (i / 3 + 0.5)}), level));
      run(manager, 2.0);
      manager.remove_ground(shelf);
      const double time = gravity > 5.0 ? 0.75 : 1.5, way = 0.5 * gravity * time * time;
      const double before = manager.state(cubes.front()).position.z();
      run(manager, time);
      for (const BodyId body : cubes) EXPECT_FALSE(manager.asleep(body)) << int(level);
      EXPECT_GT(before - manager.state(cubes.front()).position.z(), 0.5 * way)
          << int(level) << " at " << gravity;
    }
}

// Slower than what ODE takes for rest, the upper one was laid to sleep in each substep, and held the lower
// one back.
TEST(MixedStacks, FullOnesOnAStatisticalOneGoAlongWithASlowTruck) {
  for (const std::string levels : {"sff", "sfff"}) {
    Manager manager = on_floor();
    const BodyId truck = add_kinematic(manager, {3, 3, 0.2}, {0, 0, 0.3});
    std::vector<BodyId> cubes;
    for (std::size_t i = 0; i < levels.size(); ++i)
      cubes.push_back(
          add(manager, box_shape({kStackedSide, kStackedSide, kStackedSide}),
              testing::at({0.01 * double(i % 2), 0, 0.4 + (kStackedSide + 1e-3) * (double(i) + 0.5)}),
              level_of(levels[i])));
    const auto place_of = [&](BodyId body) {
      return Vec3(manager.state(body).position - manager.state(truck).position);
    };
    std::vector<Vec3> before;
    for (int i = 0; i < 360; ++i) {
      if (i == 50)
        for (const BodyId body : cubes) before.push_back(place_of(body));
      RigidState state = manager.state(truck);  // .6 m/s² at most, after 2 s
      state.velocity.x() = 0.75 * (1.0 - std::cos(0.8 * std::max(0.0, i * kFrame - 1.0)));
      manager.set_state(truck, state);
      manager.step(kFrame);
    }
    for (std::size_t i = 0; i < cubes.size(); ++i)
      EXPECT_LT((place_of(cubes[i]) - before[i]).norm(), 0.03) << levels << ", cube " << i;
  }
}

// The full one below knows that its ground goes up, or sideways; so must those that it carries.
TEST(MixedStacks, RideOnAKinematicLift) {
  constexpr double kRideSpeed = 0.7, kLift = 0.2;  // m/s, reached within a second; m, its height
  for (const std::string levels : {"fs", "ft", "fss", "fsf", "ffs"})
    for (const Vec3& way : {Vec3(Vec3::UnitZ()), Vec3(Vec3::UnitX())}) {
      if (way.x() != 0.0 && levels == "ft") continue;  // spheres roll on what moves sideways
      dInitODE2(0);
      const dWorldID world = dWorldCreate();
      const dSpaceID space = dHashSpaceCreate(nullptr);
      dWorldSetGravity(world, 0, 0, -9.81);
      const dBodyID lift = dBodyCreate(world);
      dBodySetKinematic(lift);
      dGeomSetBody(dCreateBox(space, 2, 2, kLift), lift);
      {
        Manager manager(world, space, {.signatures = coarse_signature});
        std::vector<BodyId> cubes;
        for (std::size_t i = 0; i < levels.size(); ++i)
          cubes.push_back(add(
              manager, box_shape({kStackedSide, kStackedSide, kStackedSide}),
              testing::at({0.02 * double(i % 2), 0, 0.5 * kLift + kStackedSide * (double(i) + 0.5) + 1e-3}),
              level_of(levels[i])));
        run(manager, 1.0);
        const auto place_of = [&](BodyId body) {
          const dReal* place = dBodyGetPosition(lift);
          return Vec3(manager.state(body).position - Vec3(place[0], place[1], place[2]));
        };
        std::vector<Vec3> before;
        for (const BodyId body : cubes) before.push_back(place_of(body));
        for (int i = 0; i < 300; ++i) {
          const Vec3 velocity = std::min(kRideSpeed, kRideSpeed * i * kFrame) * way;
          dBodySetLinearVel(lift, velocity.x(), velocity.y(), velocity.z());
          manager.step(kFrame);
        }
        for (std::size_t i = 0; i < cubes.size(); ++i)
          EXPECT_LT((place_of(cubes[i]) - before[i]).norm(), 0.03)
              << levels << ", cube " << i << " along " << way.transpose();
      }
      dSpaceDestroy(space);
      dWorldDestroy(world);
    }
}

/// Who is awake half a second on end, of sixty balls poured into a bin that had seventeen seconds to come to
/// rest.
int count_restless(const std::function<LevelChoice(int)>& level_of_ball, const ManagerSettings& settings,
                   std::uint32_t seed = 3) {
  constexpr double kHalf = 0.6;  // m
  constexpr int kBalls = 60, kInARow = 4;
  Manager manager(settings);
  const Vec3 viewer(-5, 0, 0.3);
  manager.set_viewpoints({&viewer, 1});
  manager.add_plane(Vec3::UnitZ(), 0.0);
  for (const double side : {-1.0, 1.0}) {
    manager.add_plane(Vec3(0, side, 0), -kHalf);
    manager.add_plane(Vec3(side, 0, 0), -kHalf);
  }
  RandomStream random(seed, 0, 0);
  const auto ball = sphere_shape(0.1);
  std::vector<BodyId> balls;
  for (int i = 0; i < kBalls; ++i) {
    const auto along = [&](int k) {
      return kHalf * (-0.8 + 1.6 * k / (kInARow - 1)) + random.uniform(-0.01, 0.01);
    };
    const double x = along(i % kInARow), y = along(i / kInARow % kInARow);
    balls.push_back(
        add(manager, ball, testing::at({x, y, 0.15 + 0.28 * (i / (kInARow * kInARow))}), level_of_ball(i)));
  }
  run(manager, 17.0);
  std::vector<int> awake(balls.size());
  for (int i = 0; i < 30; ++i) {
    manager.step(kFrame);
    for (std::size_t k = 0; k < balls.size(); ++k) awake[k] += !manager.asleep(balls[k]);
  }
  return int(std::ranges::count(awake, 30));
}

// The crowd left out what a full body stood on where that was kinematic and had been added before it.
TEST(MixedStacks, AFullOneOnAKinematicOneHoldsWhatIsPushedAgainstIt) {
  constexpr double kPush = 420.0;  // N, of 446 that friction holds
  for (const bool platform_first : {false, true}) {
    Manager manager(unmeasured());
    manager.add_plane(Vec3::UnitZ(), -5.0);
    const auto add_platform = [&] { add_kinematic(manager, {3, 3, 0.2}, {0, 0, -0.1}); };
    if (platform_first) add_platform();
    const BodyId full = manager.add_body({.shape = box_shape({0.3, 0.4, 0.3}),
                                          .state = testing::at({0, 0, 0.15}),
                                          .mass = 64.0,
                                          .level = LevelChoice::full});
    if (!platform_first) add_platform();
    const BodyId pushed = manager.add_body({.shape = box_shape({0.3, 0.3, 0.3}),
                                            .state = testing::at({0.3005, 0, 0.1505}),
                                            .mass = 27.0,
                                            .level = LevelChoice::support});
    for (int i = 0; i < 240; ++i) {
      manager.add_force(pushed, {-kPush, 0, 0});
      manager.step(kFrame);
    }
    EXPECT_NEAR(manager.state(full).position.x(), 0.0, 0.01) << platform_first;
    EXPECT_NEAR(manager.state(pushed).position.x(), 0.3, 0.01) << platform_first;
  }
}

// What a full ball had touched until three frames ago was taken to be right behind it still: a cube that
// struck it in the air bounced as off the ground, and the ball was driven down besides (122 J more of 165).
TEST(MixedStacks, NobodyGainsWhereAFullBallIsStruckAfterItBounced) {
  constexpr double kRadius = 0.12, kSide = 0.2;  // m
  const auto ball = sphere_shape(kRadius);
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables})
    for (int later = 6; later < 10; ++later) {
      Manager manager({.signatures = coarse_signature});
      manager.materials().replace(0, {0.6, 0.5, 1000.0});
      manager.add_plane(Vec3::UnitZ(), 0.0);
      RigidState falls = testing::at({0, 0, kRadius + 0.04});  // it bounces at the end of a frame
      falls.velocity = {0, 0, -3};
      const BodyId full = add(manager, ball, falls, LevelChoice::full);
      RigidState above = testing::at({0.02, later % 2 == 0 ? 0.08 : 0.0, 0.42 + 0.05 * later});
      above.velocity = {0, 0, -6};
      const BodyId cube = add(manager, box_shape({kSide, kSide, kSide}), above, level);
      double before = energy(manager, full) + energy(manager, cube);
      for (int i = 0; i < 30; ++i) {
        manager.step(kFrame);
        const double now = energy(manager, full) + energy(manager, cube);
        EXPECT_LT(now, before + 1.0) << int(level) << ", " << later << ", frame " << i;
        before = now;
      }
    }
}

// ODE meets a plane within the step in which a body reaches it: where it had found the contact above the
// plane, the way from there and back was counted as none.
TEST(MixedStacks, NobodyGainsWhereAFullBallIsStruckAsItBounces) {
  constexpr double kRadius = 0.15;  // m
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables})
    for (const double mass : {1.0, 1.5})
      for (int later = 0; later < 10; ++later) {
        Manager manager({.signatures = coarse_signature});
        manager.materials().replace(0, {0.8, 0.5, 1000.0});
        manager.add_plane(Vec3::UnitZ(), 0.0);
        const auto add_ball = [&](double height, double speed, double kilograms, LevelChoice rung) {
          RigidState state = testing::at({0, 0, height});
          state.velocity = {0, 0, -speed};
          return manager.add_body(
              {.shape = sphere_shape(kRadius), .state = state, .mass = kilograms, .level = rung});
        };
        const BodyId full = add_ball(0.32, 4.0, 1.0, LevelChoice::full),
                     other = add_ball(0.63 + 0.03 * later, 6.0, mass, level);
        double before = energy(manager, full) + energy(manager, other);
        for (int i = 0; i < 8; ++i) {
          manager.step(kFrame);
          const double now = energy(manager, full) + energy(manager, other);
          EXPECT_LT(now, before + 0.5) << int(level) << ", " << mass << " kg, " << later << ", frame " << i;
          before = now;
        }
      }
}

// A world of the caller's with a plane, onto which he makes the contacts of his own bodies.
struct HisWorld {
  HisWorld() { dWorldSetGravity(world, 0, 0, -9.81); }
  ~HisWorld() {
    dJointGroupDestroy(contacts);
    dSpaceDestroy(space);
    dWorldDestroy(world);
  }
  HisWorld(const HisWorld&) = delete;
  HisWorld& operator=(const HisWorld&) = delete;

  void meet_plane(dBodyID body) const {
    for (dGeomID geom = dBodyGetFirstGeom(body); geom; geom = dBodyGetNextGeom(geom)) {
      dContact found[8] = {};
      const int count = dCollide(geom, plane, 8, &found[0].geom, sizeof(dContact));
      for (int k = 0; k < count; ++k) {
        found[k].surface.mode = dContactApprox1 | dContactBounce;
        found[k].surface.mu = 0.5, found[k].surface.bounce = 0.4, found[k].surface.bounce_vel = 0.01;
        dJointAttach(dJointCreateContact(world, contacts, &found[k]), body, nullptr);
      }
    }
  }
  void step(Manager& manager, dBodyID body) const {
    meet_plane(body);
    manager.step(kFrame);
    dJointGroupEmpty(contacts);
  }

  dWorldID world = dWorldCreate();
  dSpaceID space = dHashSpaceCreate(nullptr);
  dGeomID plane = dCreatePlane(space, 0, 0, 1, 0);
  dJointGroupID contacts = dJointGroupCreate(0);
};

// His cube falls onto his plane, 4 mm above it: it was taken to lie there, and a box that struck it bounced
// as off the ground, while his own contact came a step later (125 J became 273).
TEST(MixedStacks, NobodyGainsWhereACallersBodyIsStruckJustOverHisGround) {
  constexpr double kCubeSize = 0.3, kCubeMass = 10.0;  // m, kg
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables}) {
    const HisWorld his;
    Manager manager(his.world, his.space, {.signatures = coarse_signature});
    const dBodyID cube = dBodyCreate(his.world);
    dMass mass;
    dMassSetBoxTotal(&mass, kCubeMass, kCubeSize, kCubeSize, kCubeSize);
    dBodySetMass(cube, &mass);
    dBodySetPosition(cube, 0, 0, 0.16);
    dGeomSetBody(dCreateBox(his.space, kCubeSize, kCubeSize, kCubeSize), cube);
    const BodyId box = manager.add_body({.shape = box_shape({0.2, 0.3, 0.4}),
                                         .state = {.position = {0.03, 0.02, 0.65},
                                                   .orientation = rotation_from_vector({0.2, 0, 0}),
                                                   .velocity = {0.3, 0, -3},
                                                   .angular_velocity = {0.5, 1, 0}},
                                         .mass = kCubeMass,
                                         .level = level});
    const auto energy_of_both = [&] {
      const dReal *v = dBodyGetLinearVel(cube), *w = dBodyGetAngularVel(cube);
      const double inertia = kCubeMass * kCubeSize * kCubeSize / 6.0;
      return energy(manager, box) + 0.5 * kCubeMass * dCalcVectorLengthSquare3(v) +
             0.5 * inertia * dCalcVectorLengthSquare3(w) + kCubeMass * 9.81 * dBodyGetPosition(cube)[2];
    };
    double before = energy_of_both();
    for (int i = 0; i < 6; ++i) {
      his.step(manager, cube);
      const double now = energy_of_both();
      EXPECT_LT(now, before + 1.0) << int(level) << ", frame " << i;
      before = now;
    }
  }
}

// Each half second one that statistical bodies held up was laid to sleep, woken by ODE, and fell for a frame:
// of these 19 and 33 never slept. (A few may roll on, or spin, as balls do.)
TEST(MixedHeap, ComesToRest) {
  EXPECT_LE(count_restless([](int i) { return i % 2 ? LevelChoice::full : LevelChoice::support; },
                           {.signatures = coarse_signature}),
            4);
  EXPECT_LE(count_restless([](int) { return LevelChoice::automatic; },
                           {.policy = {.policy = DistancePolicy{.full_within = 5.0, .support_within = 1e9}},
                            .signatures = coarse_signature}),
            4);
}

// Those of `tables` at the border keep a part of gravity's step, by which they do not move: of one pour's 19
// never slept. (From pour to pour it is none to seven.)
TEST(MixedHeap, ComesToRestAtTheBorderOfTables) {
  constexpr int kPours = 6;
  int restless = 0;
  for (std::uint32_t seed = 0; seed < kPours; ++seed)
    restless +=
        count_restless([](int) { return LevelChoice::automatic; },
                       {.policy = {.policy = DistancePolicy{.full_within = 1e-9, .support_within = 5.0}},
                        .signatures = coarse_signature},
                       seed);
  EXPECT_LE(restless, 5 * kPours);
}

// L-shapes of `tables`, a tenth of `support` and a twentieth full among them: of eight such heaps 128 were
// awake after five seconds (now 8), as each guest hovered over what bore it, turned freely on it, and fell
// anew whenever it woke.
TEST(MixedHeap, OfAllRungsComesToRest) {
  constexpr int kBodies = 150;
  const auto l = std::make_shared<const Shape>(make_shape("L", make_l(0.4, 0.3, 0.1, 0.1)));
  int awake = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    Manager manager = on_floor({.signatures = coarse_signature});
    RandomStream random(seed, 0, 0);
    std::vector<BodyId> heap;
    for (int i = 0; i < kBodies; ++i) {
      const double share = random.uniform();
      const Vec3 place(random.uniform(-0.7, 0.7), random.uniform(-0.7, 0.7), 0.3 + 0.03 * i);
      heap.push_back(add(manager, l, {.position = place, .orientation = random.orientation()},
                         share < 0.1    ? LevelChoice::support
                         : share < 0.15 ? LevelChoice::full
                                        : LevelChoice::tables));
    }
    run(manager, 5.0);
    awake += int(std::ranges::count_if(heap, [&](BodyId body) { return !manager.asleep(body); }));
  }
  EXPECT_LE(awake, 40);
}

// What is near is full, as a game has it. Solved on two rungs in turn, such a cluster trembles, and each of
// it that did, or that a neighbour who had only been woken touched, kept all of it awake: 64 in these heaps
// were so after ten seconds, in three of the six. All full they sleep by then.
TEST(MixedHeap, AFullClusterInItComesToRest) {
  constexpr int kBodies = 150;
  const auto box = box_shape({0.2, 0.3, 0.4});
  int awake = 0;
  for (const LevelChoice others : {LevelChoice::support, LevelChoice::tables})
    for (const std::uint64_t seed : {3, 4, 5}) {
      Manager manager = on_floor({.signatures = coarse_signature});
      RandomStream random(seed, 0, 0);
      std::vector<BodyId> heap;
      for (int i = 0; i < kBodies; ++i) {
        const double angle = random.uniform(0.0, 6.2831853), radius = 1.1 * std::sqrt(random.uniform());
        heap.push_back(add(
            manager, box,
            {.position = {radius * std::cos(angle), radius * std::sin(angle), 0.2 + random.uniform(0.0, 4.4)},
             .orientation = random.orientation()},
            radius < 0.5 ? LevelChoice::full : others));
      }
      run(manager, 10.0);
      awake += int(std::ranges::count_if(heap, [&](BodyId body) { return !manager.asleep(body); }));
    }
  EXPECT_LE(awake, 5);
}

// ODE looks for no contact between what sleeps and what is kinematic: one that it knew from before was taken
// for a gap as deep as the body's place on the kinematic one, and what lay on what was woken fell by 1.8 mm.
TEST(MixedStacks, WhatLiesOnAWokenOneOnAKinematicBodyLiesStill) {
  for (const bool floor_first : {false, true}) {
    Manager manager(unmeasured());
    const auto add_floor = [&] { add_kinematic(manager, {6, 6, 0.4}, {0, 0, -0.2}); };
    if (floor_first) add_floor();
    const auto cube = box_shape({kStackedSide, kStackedSide, kStackedSide});
    const BodyId below = add(manager, cube, testing::at({0, 0, 0.5 * kStackedSide}), LevelChoice::full),
                 above = add(manager, cube, testing::at({0, 0, 1.5 * kStackedSide}), LevelChoice::support);
    if (!floor_first) add_floor();
    int woken = 0;
    for (int frame = 0; frame < 180; ++frame) {
      if (manager.asleep(below)) manager.wake(below), manager.wake(above), ++woken;
      manager.step(kFrame);
      ASSERT_NEAR(manager.state(above).position.z(), 1.5 * kStackedSide, 2e-4) << frame;
    }
    EXPECT_GE(woken, 2);
  }
}

// ODE knows no contact of a body before its first step, nor where the whole stack was put elsewhere.
TEST(MixedStacks, WhatIsLaidOnANewFullOneLiesFromTheFirstStepOn) {
  const auto cube = box_shape({kStackedSide, kStackedSide, kStackedSide});
  for (const bool on_box : {false, true})
    for (const double dt : {1.0 / 60.0, 1.0 / 30.0})
      for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables}) {
        Manager manager({.signatures = coarse_signature});
        if (on_box)
          manager.add_static_box({20, 20, 1}, {0, 0, -0.5}, Quat::Identity());
        else
          manager.add_plane(Vec3::UnitZ(), 0.0);
        const auto place = [&](double x, double layer) {
          return testing::at({x, 0, (layer + 0.5) * kStackedSide});
        };
        const BodyId lower = add(manager, cube, place(0, 0), LevelChoice::full),
                     upper = add(manager, cube, place(0, 1), level);
        const auto expect_lies = [&](double x) {
          for (int i = 0; i < 30; ++i) {
            manager.step(dt);
            EXPECT_LT(manager.state(upper).velocity.norm(), 0.01) << on_box << ' ' << dt << ' ' << i;
          }
          EXPECT_NEAR((manager.state(upper).position - place(x, 1).position).norm(), 0.0, 1e-3);
        };
        expect_lies(0.0);
        manager.set_state(lower, place(5, 0)), manager.set_state(upper, place(5, 1));
        expect_lies(5.0);
      }
}

// By the law of the ground that it is on, whatever the first material's: a cart that coasts over ice.
TEST(MixedStacks, WhatRidesOnAFullOneOverIceGoesAlong) {
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables})
    for (const bool on_box : {false, true}) {
      Manager manager({.signatures = coarse_signature});
      const MaterialId ice = manager.materials().add({.restitution = 0.0, .friction = 0.5});
      manager.materials().set_law(0, ice, {.restitution = 0.0, .friction = 0.0});
      if (on_box)
        manager.add_static_box({20, 20, 1}, {0, 0, -0.5}, Quat::Identity(), ice);
      else
        manager.add_plane(Vec3::UnitZ(), 0.0, ice);
      const BodyId cart = add(manager, box_shape({2, 2, 0.2}), testing::at({0, 0, 0.1}, {0.5, 0, 0}),
                              LevelChoice::full),
                   crate = add(manager, box_shape({kStackedSide, kStackedSide, kStackedSide}),
                               testing::at({0, 0, 0.2 + 0.5 * kStackedSide}, {0.5, 0, 0}), level);
      run(manager, 2.0);
      EXPECT_NEAR(manager.state(cart).velocity.x(), 0.5, 2e-3);
      EXPECT_NEAR(manager.state(crate).velocity.x(), 0.5, 2e-3);
      EXPECT_NEAR(manager.state(crate).position.x(), manager.state(cart).position.x(), 2e-3);
    }
}

// Both fly on as thrown by a lift that stops.
TEST(MixedStacks, AStackOnALiftThatStopsFliesOnTogether) {
  const auto cube = box_shape({kStackedSide, kStackedSide, kStackedSide});
  constexpr double kRises = 1.0;  // m/s
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables}) {
    Manager manager({.signatures = coarse_signature});
    const GroundId lift = manager.add_static_box({4, 4, 1}, {0, 0, -0.5}, Quat::Identity());
    const auto at_layer = [&](int layer) {
      return testing::at({0, 0, (layer + 0.5) * kStackedSide}, {0, 0, kRises});
    };
    const BodyId lower = manager.add_body(
                     {.shape = cube, .state = at_layer(0), .mass = 10.0, .level = LevelChoice::full}),
                 upper =
                     manager.add_body({.shape = cube, .state = at_layer(1), .mass = 100.0, .level = level});
    for (int i = 0; i < 40; ++i) {
      manager.move_ground(
          lift, {.position = {0, 0, -0.5 + kRises * kFrame * i}, .velocity = {0, 0, i < 39 ? kRises : 0.0}});
      manager.step(kFrame);
    }
    const double thrown = kRises - 9.81 * kFrame;
    EXPECT_NEAR(manager.state(lower).velocity.z(), thrown, 0.02);
    EXPECT_NEAR(manager.state(upper).velocity.z(), thrown, 0.02);
  }
}

// An L of two boxes: his contacts come and go as ODE's rounding has it, since its ERP leaves no depth.
TEST(MixedStacks, ACallersBodyLiesQuietlyUnderAHeavySleeper) {
  struct Part {
    Vec3 sides, center;  // m
  };
  const std::array<Part, 2> parts{{{{0.3, 0.08, 0.1}, {0, -0.06, 0}}, {{0.08, 0.12, 0.1}, {-0.11, 0.04, 0}}}};
  constexpr double kLMass = 10.0, kTurned = 0.2;  // kg, rad
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables}) {
    const HisWorld his;
    Manager manager(his.world, his.space, {.signatures = coarse_signature});
    dMass mass, part_mass;
    dMassSetZero(&mass);
    for (const Part& part : parts) {
      dMassSetBox(&part_mass, 1.0, part.sides.x(), part.sides.y(), part.sides.z());
      dMassTranslate(&part_mass, part.center.x(), part.center.y(), part.center.z());
      dMassAdd(&mass, &part_mass);
    }
    const Vec3 middle(mass.c[0], mass.c[1], mass.c[2]);
    dMassTranslate(&mass, -middle.x(), -middle.y(), -middle.z());
    dMassAdjust(&mass, kLMass);
    const dBodyID body = dBodyCreate(his.world);
    dBodySetMass(body, &mass);
    for (const Part& part : parts) {
      const Vec3 at = part.center - middle;
      const dGeomID geom = dCreateBox(his.space, part.sides.x(), part.sides.y(), part.sides.z());
      dGeomSetBody(geom, body);
      dGeomSetOffsetPosition(geom, at.x(), at.y(), at.z());
    }
    const dQuaternion q = {std::cos(0.5 * kTurned), 0, 0, std::sin(0.5 * kTurned)};
    dBodySetPosition(body, 0.013, 0.3, 0.0505);
    dBodySetQuaternion(body, q);
    manager.add_body({.shape = box_shape({kStackedSide, kStackedSide, kStackedSide}),
                      .state = {.position = {0.013, 0.3, 0.1 + 0.5 * kStackedSide + 0.002}},
                      .mass = 10.0 * kLMass,
                      .level = level});
    double fastest = 0.0;  // m/s
    for (int i = 0; i < 240; ++i) {
      his.step(manager, body);
      if (i > 60) fastest = std::max(fastest, std::sqrt(dCalcVectorLengthSquare3(dBodyGetLinearVel(body))));
    }
    EXPECT_LT(fastest, 0.05) << int(level);
  }
}

}  // namespace
}  // namespace lodestone
