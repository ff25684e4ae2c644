// Light full bodies between heavy ones of other rungs: struck many times in a step, they must not be thrown
// out.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "lod/statistical/full_neighbor.h"
#include "reference/mesh/mesh.h"
#include "reference/random.h"
#include "tests/lod/callers/callers_scene.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

std::shared_ptr<const Shape> l_shape() {
  return std::make_shared<const Shape>(make_shape("l", make_l(0.3, 0.2, 0.08, 0.1)));
}

/// Their energy, that in the world's gravity too, never exceeds `most` times what it is now.
void expect_no_gain(Manager& manager, std::span<const BodyId> bodies, int steps, double most) {
  const auto sum = [&] {
    double all = 0.0;
    for (const BodyId body : bodies)
      all += energy(manager, body) -
             manager.mass(body) * (kGravity + manager.gravity().z()) * manager.state(body).position.z();
    return all;
  };
  const double before = sum();
  for (int i = 0; i < steps; ++i) {
    manager.step(kFrame);
    ASSERT_LT(sum(), most * before) << "at step " << i;
  }
}

// Where their solver left it a thin rod lies otherwise than it spins; it was given up to 60 times its
// energy.
TEST(FindStart, ARodThatSpinsKeepsItsEnergyWhereItIsPut) {
  const auto rod = box_shape({0.04, 0.04, 0.8});
  FullNeighbor neighbor;
  neighbor.shape = rod.get();
  neighbor.state = testing::at({0, 0, 0.5}, {0, 0, -1}, {0, 5, 200});
  neighbor.hit.linear = {0, 0, 1};
  neighbor.end = neighbor.state;
  neighbor.end.orientation = Quat(Eigen::AngleAxisd(0.6, Vec3::UnitX()));
  const RigidState start = find_start(neighbor, {0, 0, -kGravity}, kFrame, 4);
  const auto turning = [&](const RigidState& state) {
    const Vec3 spin = state.orientation.conjugate() * state.angular_velocity;
    return spin.dot(rod->inertia_per_mass * spin);
  };
  EXPECT_NEAR(turning(start), turning(neighbor.state), 1e-9);
  // Turning on so it arrives there.
  const Quat end = rotation_from_vector(kFrame * start.angular_velocity) * start.orientation;
  EXPECT_LT(end.angularDistance(neighbor.end.orientation), 1e-9);
}

TEST(Squeezed, BetweenTwoThatCloseInNoEnergyIsMade) {
  const auto l = l_shape(), cube = box_shape({0.5, 0.5, 0.5});
  constexpr double kSqueezedMass = 4.0, kPressing = 30.0 * kSqueezedMass, kClosing = 2.0;  // kg, m/s
  for (std::uint64_t seed = 0; seed < 16; ++seed) {
    RandomStream random(seed, 0, 0);
    ManagerSettings settings = unmeasured();
    settings.gravity = Vec3::Zero();
    Manager manager(settings);
    std::vector<BodyId> bodies{manager.add_body({.shape = l,
                                                 .state = {.orientation = random.orientation()},
                                                 .mass = kSqueezedMass,
                                                 .level = LevelChoice::full})};
    for (const double side : {-1.0, 1.0})
      bodies.push_back(manager.add_body(
          {.shape = cube,
           .state = testing::at({side * 0.55, random.uniform(-0.1, 0.1), 0.0}, {-side * kClosing, 0, 0}),
           .mass = kPressing,
           .level = LevelChoice::support}));
    SCOPED_TRACE(seed);
    expect_no_gain(manager, bodies, 40, 1.02);
  }
}

TEST(Squeezed, OnTheGroundItIsNotThrownOut) {
  const auto l = l_shape(), crate = box_shape({0.3, 0.45, 0.6});
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    RandomStream random(seed, 0, 0);
    Manager manager = on_floor(unmeasured());
    const BodyId light = add(manager, l, testing::at({0, 0, 0.05}), LevelChoice::full);
    run(manager, 0.5);
    const BodyId heavy = manager.add_body(
        {.shape = crate,
         .state = {.position = Vec3(random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), 1.2),
                   .orientation = random.orientation(),
                   .velocity = Vec3(0, 0, -3)},
         .mass = 300.0,
         .level = LevelChoice::support});
    SCOPED_TRACE(seed);
    const BodyId both[] = {light, heavy};
    expect_no_gain(manager, both, 90, 1.2);
  }
}

// By a walker of the caller's, .2 m deep, who then goes back; his geom is put there each frame, or his
// kinematic body has a velocity. Plain ODE has it fly off at up to 16 m/s (trimesh) and 613 m/s (box) in such
// corners.
TEST(Squeezed, IntoACornerAFullCrateIsNotThrownOut) {
  constexpr double kFarthest = 0.36;  // m: of the walker along x
  const auto crate_shape = box_shape({0.5, 0.5, 0.5});
  for (const bool has_body : {false, true})
    for (const double speed : {0.1, 0.2, 0.3, 0.5})
      for (const double aside : {0.0, 0.05, -0.05, 0.1}) {
        CallersScene scene;
        dWorldSetGravity(scene.world, 0, 0, -kGravity);
        dCreatePlane(scene.space, 0, 0, 1, 0);
        scene.box({0.2, 4, 2}, {1, 0, 1}), scene.box({4, 0.2, 2}, {0, 1, 1});
        Manager manager(scene.world, scene.space, unmeasured());
        const BodyId crate = manager.add_body({.shape = crate_shape,
                                               .state = testing::at({0.55, 0.55, 0.25}),
                                               .mass = 60.0,
                                               .level = LevelChoice::full});
        const dGeomID walker = dCreateCapsule(scene.space, 0.3, 1.2);
        const dBodyID body = has_body ? dBodyCreate(scene.world) : nullptr;
        if (body) dBodySetKinematic(body), dGeomSetBody(walker, body);
        const double there = (kFarthest + 0.3) / speed;  // s
        const auto place_at = [&](double time) {
          return time < there ? -0.3 + speed * time : std::max(-0.5, kFarthest - 0.5 * (time - there));
        };
        double fastest = 0.0, lowest = 1.0;
        for (int i = 0; i < int((there + 2.0) / kFrame); ++i) {
          const double x = place_at(i * kFrame), goes = (place_at((i + 1) * kFrame) - x) / kFrame;
          dGeomSetPosition(walker, x, x + aside, 0.95);
          if (body) dBodySetLinearVel(body, goes, goes, 0);
          manager.step(kFrame);
          fastest = std::max(fastest, manager.state(crate).velocity.norm());
          lowest = std::min(lowest, manager.state(crate).position.z());
        }
        EXPECT_LT(fastest, 15.0) << has_body << ' ' << speed << ' ' << aside;
        EXPECT_GT(lowest, 0.23) << has_body << ' ' << speed << ' ' << aside;
      }
}

// Full on both sides of the blow, statistical below: what one of ODE's backs is known from its own contacts.
TEST(Squeezed, UnderAHeavyFullOneNoEnergyIsMade) {
  const auto crate = box_shape({0.3, 0.3, 0.3}), torso = box_shape({0.35, 0.2, 0.5}),
             limb = box_shape({0.12, 0.12, 0.45});
  constexpr double kTop = 0.3;  // m
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    RandomStream random(seed, 1, 0);
    Manager manager = on_floor(unmeasured());
    std::vector<BodyId> bodies;
    for (int i = 0; i < 9; ++i)
      bodies.push_back(manager.add_body({.shape = crate,
                                         .state = testing::at({(i % 3 - 1) * 0.31, (i / 3 - 1) * 0.31, 0.15}),
                                         .mass = 10.0,
                                         .level = LevelChoice::support}));
    const Quat lying = Quat(Eigen::AngleAxisd(random.uniform(-3.0, 3.0), Vec3::UnitZ())) *
                       Quat(Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitX()));
    bodies.push_back(manager.add_body(
        {.shape = limb,
         .state = {Vec3(random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), kTop + 0.0605), lying},
         .mass = 4.0,
         .level = LevelChoice::full}));
    run(manager, 1.0);
    bodies.push_back(
        manager.add_body({.shape = torso,
                          .state = {Vec3(random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), kTop + 0.55),
                                    random.orientation(), Vec3(0, 0, -5)},
                          .mass = 30.0,
                          .level = LevelChoice::full}));
    SCOPED_TRACE(seed);
    expect_no_gain(manager, bodies, 60, 1.01);
  }
}

// A rod on the floor, a crate of 70 times its weight on it and another that falls on that. The rod was given
// what the crates gave each other, or what pressed on it, without what backed it: up to 286 kJ in a step.
TEST(Squeezed, UnderTwoHeavyOnesARodIsNotThrownOut) {
  const auto rod = box_shape({0.8, 0.04, 0.04}), crate = box_shape({0.45, 0.45, 0.45});
  constexpr double kRodMass = 1.3, kCrateMass = 91.0, kGain = 30.0;  // kg, kg, J: 3 cm of a crate's weight
  for (const LevelChoice lower : {LevelChoice::full, LevelChoice::support})
    for (std::uint64_t seed = 0; seed < 24; ++seed) {
      RandomStream random(seed, 2, 0);
      Manager manager = on_floor(unmeasured());
      std::vector<BodyId> bodies{manager.add_body(
          {.shape = rod, .state = testing::at({0, 0, 0.02}), .mass = kRodMass, .level = LevelChoice::full})};
      const auto drop = [&](double height, LevelChoice level) {
        const Vec3 place(random.uniform(-0.25, 0.25), random.uniform(-0.15, 0.15), height);
        bodies.push_back(manager.add_body({.shape = crate,
                                           .state = {.position = place, .orientation = random.orientation()},
                                           .mass = kCrateMass,
                                           .level = level}));
      };
      const auto sum = [&] {
        double all = 0.0;
        for (const BodyId body : bodies) all += energy(manager, body);
        return all;
      };
      drop(0.63, lower);
      double before = sum();
      for (int i = 0; i < 200; ++i) {
        if (i == 60) drop(1.1, LevelChoice::support), before = sum();
        manager.step(kFrame);
        const double now = sum();
        ASSERT_LT(now - before, kGain) << int(lower) << ' ' << seed << " at step " << i;
        before = now;
      }
    }
}

TEST(Squeezed, WhatPressesOnALightOneAndWhatBacksItAreForcesTogether) {
  const auto cube = box_shape({0.2, 0.2, 0.2});
  const auto pressed = [&](double mass, double by) {
    FullNeighbor neighbor;
    neighbor.shape = cube.get(), neighbor.mass = mass;
    neighbor.push.linear = Vec3(0, 0, -by);
    neighbor.backing.linear = Vec3(0, 0, by + 1);
    return neighbor;
  };
  FullNeighbor light = pressed(2.0, 50.0), heavy = pressed(2.0, 10.0);
  answer_hits({&light, 1}, {});
  answer_hits({&heavy, 1}, {});
  EXPECT_LT((light.push.linear - Vec3(0, 0, 1)).norm(), 1e-12);
  EXPECT_LT((heavy.push.linear - Vec3(0, 0, -10)).norm(), 1e-12);  // ODE holds it up
}

// A heavy one that is squeezed gives it on; what is light under it is struck by no more than is left.
TEST(Squeezed, WhatIsLightUnderOneThatIsStruckIsSqueezedToo) {
  const auto cube = box_shape({0.2, 0.2, 0.2});
  for (const double mass : {0.5, 200.0}) {
    FullNeighbor neighbors[2];
    for (FullNeighbor& n : neighbors) n.shape = cube.get();
    neighbors[0].mass = 50.0, neighbors[1].mass = mass;
    neighbors[0].fastest_hit = 2.0;
    neighbors[0].backed_hit.linear = Vec3(0, 0, -300);
    neighbors[1].backing.linear = Vec3(0, 0, 290);  // by the ground
    const FullExchange exchange{
        .first = 0, .second = 1, .on_first = {Vec3(0, 0, 290)}, .on_second = {Vec3(0, 0, -290)}};
    answer_hits(neighbors, {&exchange, 1});
    EXPECT_LT((neighbors[0].hit.linear - Vec3(0, 0, -10)).norm(), 1e-12);
    EXPECT_LT((neighbors[1].hit.linear - Vec3(0, 0, mass < 1.0 ? 0 : -290)).norm(), 1e-12) << mass;
  }
}

TEST(Squeezed, WhatIsLeftOfAHitIsItsSum) {
  const auto cube = box_shape({0.2, 0.2, 0.2});
  FullNeighbor neighbor;
  neighbor.shape = cube.get(), neighbor.mass = 2.0;
  neighbor.fastest_hit = 3.0;
  // Once, and nothing is behind it: all of it.
  neighbor.hit.linear = Vec3(0, 0, -8);
  answer_hits({&neighbor, 1}, {});
  EXPECT_EQ(neighbor.hit.linear, Vec3(0, 0, -8));
  EXPECT_TRUE(neighbor.push.is_zero());
  // What a push takes back is a push.
  neighbor.push.linear = Vec3(1, 0, 6);
  answer_hits({&neighbor, 1}, {});
  EXPECT_LT((neighbor.hit.linear - Vec3(0, 0, -2)).norm(), 1e-12);
  EXPECT_LT((neighbor.push.linear - Vec3(1, 0, 0)).norm(), 1e-12);
  // Against the ground, many times: what is left.
  neighbor.hit = {}, neighbor.push = {};
  neighbor.backed_hit.linear = Vec3(4, 0, -200), neighbor.backing.linear = Vec3(-3, 0, 201);
  answer_hits({&neighbor, 1}, {});
  EXPECT_LT((neighbor.hit.linear - Vec3(1, 0, 1)).norm(), 1e-12);
  EXPECT_TRUE(neighbor.push.is_zero());
}

}  // namespace
}  // namespace lodestone
