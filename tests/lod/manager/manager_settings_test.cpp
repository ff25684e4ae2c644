// What of a manager's settings can change while it runs.
#include <gtest/gtest.h>

#include "tests/lod/manager/manager_fixture.h"
#include "tests/message_of.h"

namespace lodestone {
namespace {

using namespace testing;

TEST(ManagerGravity, ActsOnEveryRungFromTheNextStepOn) {
  Manager manager{unmeasured()};
  const auto box = box_shape({0.2, 0.2, 0.2});
  const BodyId bodies[] = {add(manager, box, at({0, 0, 0}), LevelChoice::support),
                           add(manager, box, at({5, 0, 0}), LevelChoice::full)};
  Vec3 expected = Vec3::Zero();
  for (const Vec3& gravity : {Vec3(0, 0, -9.81), Vec3(3, 0, 0), Vec3(0, 0, 0), Vec3(0, -1.62, 1)}) {
    manager.set_gravity(gravity);
    EXPECT_EQ(manager.gravity(), gravity);
    for (int i = 0; i < 10; ++i) manager.step(kFrame);
    expected += 10 * kFrame * gravity;
    for (const BodyId body : bodies) EXPECT_LT((manager.state(body).velocity - expected).norm(), 1e-6);
  }
}

TEST(ManagerGravity, WakesEverybody) {
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::full}) {
    Manager manager = on_floor();
    const BodyId body = add(manager, box_shape({0.2, 0.2, 0.2}), at({0, 0, 0.1}), level);
    run(manager, 2.0);
    ASSERT_TRUE(manager.asleep(body));
    manager.set_gravity({0, 0, 4});
    run(manager, 0.5);
    EXPECT_FALSE(manager.asleep(body));
    EXPECT_NEAR(manager.state(body).position.z(), 0.1 + 0.5 * 4 * 0.25, 0.05);
  }
}

// As games set it, in each frame: it ended the clips in which bodies settle, too.
TEST(ManagerGravity, TheSameAgainChangesNothing) {
  for (const LevelChoice level : {LevelChoice::tables, LevelChoice::support, LevelChoice::full}) {
    std::uint64_t hash = 0;
    for (const bool again : {false, true}) {
      Manager manager = on_floor({.signatures = coarse_signature});
      const BodyId body =
          add(manager, box_shape({0.2, 0.3, 0.4}),
              {.position = {0, 0, 0.5}, .orientation = Quat(0.8, 0.3, 0.5, 0.1).normalized()}, level);
      for (int i = 0; i < 300; ++i) {
        if (again) manager.set_gravity(manager.gravity());
        manager.step(kFrame);
      }
      EXPECT_TRUE(manager.asleep(body));
      EXPECT_TRUE(!again || manager.state_hash() == hash) << int(level);
      hash = manager.state_hash();
    }
  }
}

TEST(ManagerGravity, WhatIsNotFiniteIsRefused) {
  Manager manager{unmeasured()};
  const Vec3 before = manager.gravity();
  EXPECT_EQ(message_of([&] {
              manager.set_gravity({0, NAN, 1});
            }),
            "gravity: found (0, nan, 1), expected finite numbers");
  EXPECT_THROW(manager.set_gravity({0, 0, INFINITY}), InputError);
  EXPECT_EQ(manager.gravity(), before);
}

// More substeps: the fall of a full body nears the parabola (ODE's error is half of g h t).
TEST(ManagerSubsteps, ErrorsShrinkWithTheSubstep) {
  double before = 1.0;
  for (const int substeps : {1, 4, 16}) {
    Manager manager{unmeasured()};
    const BodyId body = add(manager, box_shape({0.2, 0.2, 0.2}), at({0, 0, 0}), LevelChoice::full);
    manager.set_full_substeps(substeps);
    run(manager, 0.5);
    const double error = std::abs(manager.state(body).position.z() + 0.5 * kGravity * 0.25);
    EXPECT_LT(error, 0.4 * before) << substeps;
    before = error;
  }
}

TEST(ManagerSettingsOutOfRange, AreRefusedByName) {
  Manager manager{unmeasured()};
  EXPECT_EQ(message_of([&] { manager.set_full_substeps(0); }), "full_substeps: found 0, expected 1 or more");
  EXPECT_EQ(message_of([&] { manager.set_threads(-1); }), "threads: found -1, expected 1 or more");
  const auto refused = [](const auto& change) {
    ManagerSettings settings = unmeasured();
    change(settings);
    return message_of([&] { Manager{settings}; });
  };
  EXPECT_EQ(refused([](ManagerSettings& s) { s.threads = 0; }), "threads: found 0, expected 1 or more");
  EXPECT_EQ(refused([](ManagerSettings& s) { s.full_substeps = -3; }),
            "full_substeps: found -3, expected 1 or more");
  EXPECT_EQ(refused([](ManagerSettings& s) { s.sleep.speed = 0; }),
            "sleep speed: found 0, expected a positive, finite number");
  EXPECT_EQ(refused([](ManagerSettings& s) { s.sleep.time = -1; }),
            "sleep time: found -1, expected 0 or more");
  EXPECT_EQ(refused([](ManagerSettings& s) { s.audit_ms = -1; }), "audit_ms: found -1, expected 0 or more");
  EXPECT_EQ(refused([](ManagerSettings& s) { s.events.least_speed = NAN; }),
            "least_speed: found nan, expected 0 or more");
  EXPECT_NE(refused([](ManagerSettings& s) { s.gravity.x() = NAN; }), kNothingThrown);
  EXPECT_EQ(refused([](ManagerSettings&) {}), kNothingThrown);
}

// However many threads there are, and when they change: the same to the bit.
TEST(ManagerThreads, ChangeNothing) {
  const auto hash_with = [](int first, int then) {
    ManagerSettings settings = unmeasured();
    settings.threads = first;
    Manager manager = on_floor(settings);
    const auto box = box_shape({0.2, 0.3, 0.4});
    for (int i = 0; i < 30; ++i) add(manager, box, at({0.25 * (i % 5), 0.25 * (i / 5), 0.4 + 0.01 * i}));
    for (int i = 0; i < 20; ++i) manager.step(kFrame);
    manager.set_threads(then);
    for (int i = 0; i < 20; ++i) manager.step(kFrame);
    return manager.state_hash();
  };
  const std::uint64_t one = hash_with(1, 1);
  EXPECT_EQ(hash_with(1, 4), one);
  EXPECT_EQ(hash_with(3, 2), one);
}

}  // namespace
}  // namespace lodestone
