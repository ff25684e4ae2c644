// Ground that comes while bodies sleep, that is put on, and that goes through a hitch.
#include <gtest/gtest.h>
#include <ode/ode.h>

#include <tuple>
#include <utility>

#include "reference/error.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

constexpr double kCube = 0.3, kRisen = 0.1;  // m

enum class NewGround { plane, box, mesh, their_plane, their_box, their_plane_moved };

class GroundThatComes : public ::testing::TestWithParam<NewGround> {
 protected:
  GroundThatComes() { dWorldSetGravity(world_, 0, 0, -9.81); }
  ~GroundThatComes() override {
    dSpaceDestroy(space_);
    dWorldDestroy(world_);
  }
  void come(Manager& manager) {
    switch (GetParam()) {
      case NewGround::plane:
        manager.add_plane(Vec3::UnitZ(), kRisen);
        break;
      case NewGround::box:
        manager.add_static_box({4, 4, 2 * kRisen}, Vec3::Zero(), Quat::Identity());
        break;
      case NewGround::mesh:
        manager.add_static_mesh(
            {.vertices = {{-3, -3, kRisen}, {3, -3, kRisen}, {3, 3, kRisen}, {-3, 3, kRisen}},
             .faces = {{0, 1, 2}, {0, 2, 3}}});
        break;
      case NewGround::their_plane:
        their_ = dCreatePlane(space_, 0, 0, 1, kRisen);
        break;
      case NewGround::their_box:
        their_ = dCreateBox(space_, 4, 4, 2 * kRisen);
        break;
      case NewGround::their_plane_moved:
        dGeomPlaneSetParams(floor_, 0, 0, 1, kRisen);
        break;
    }
  }
  dWorldID world_ = dWorldCreate();
  dSpaceID space_ = dHashSpaceCreate(nullptr);
  dGeomID floor_ = dCreatePlane(space_, 0, 0, 1, 0), their_ = nullptr;
};

TEST_P(GroundThatComes, RaisesWhoSleepsInIt) {
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables}) {
    dGeomPlaneSetParams(floor_, 0, 0, 1, 0);
    Manager manager(world_, space_, {.signatures = coarse_signature});
    const BodyId sunk = add(manager, box_shape({kCube, kCube, kCube}), testing::at({0, 0, kCube / 2}), level),
                 above =
                     add(manager, box_shape({kCube, kCube, kCube}), testing::at({0, 0, 1.5 * kCube}), level);
    run(manager, 2.0);
    ASSERT_TRUE(manager.asleep(sunk)) << int(level);
    come(manager);
    run(manager, 4.0);
    EXPECT_NEAR(manager.state(sunk).position.z(), kRisen + kCube / 2, 0.01 * kCube) << int(level);
    EXPECT_NEAR(manager.state(above).position.z(), kRisen + 1.5 * kCube, 0.1 * kCube) << int(level);
    EXPECT_TRUE(manager.asleep(sunk)) << int(level);
    if (their_) dGeomDestroy(std::exchange(their_, nullptr));
  }
}

INSTANTIATE_TEST_SUITE_P(All, GroundThatComes,
                         ::testing::Values(NewGround::plane, NewGround::box, NewGround::mesh,
                                           NewGround::their_plane, NewGround::their_box,
                                           NewGround::their_plane_moved));

// Three cubes that sleep on a box.
struct StackOnShelf {
  static constexpr double kSide = 0.4;  // m
  explicit StackOnShelf(LevelChoice level) {
    for (int i = 0; i < 3; ++i)
      stack.push_back(
          add(manager, box_shape({kSide, kSide, kSide}), testing::at({0, 0, (i + 0.5) * kSide}), level));
    run(manager, 3.0);
    for (const BodyId body : stack) EXPECT_TRUE(manager.asleep(body)) << int(level);
  }
  /// Once, and leaves it time to come to rest.
  void raise(double by) {
    manager.move_ground(shelf, testing::at({0, 0, by - 0.5}));
    run(manager, 5.0);
  }
  double height(std::size_t i) const { return manager.state(stack[i]).position.z(); }

  Manager manager{{.signatures = coarse_signature}};
  GroundId shelf = manager.add_static_box({2, 2, 1}, {0, 0, -0.5}, Quat::Identity());
  std::vector<BodyId> stack;
};

// By less than the lowest falls in a few steps: those above hung in the air, asleep.
TEST(ManagerGround, WhatStandsOnGroundThatSinksALittleComesDown) {
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables})
    for (const double down : {0.003, 0.03}) {
      StackOnShelf on(level);
      std::vector<double> before;
      for (std::size_t i = 0; i < on.stack.size(); ++i) before.push_back(on.height(i));
      on.raise(-down);
      for (std::size_t i = 0; i < on.stack.size(); ++i)
        EXPECT_NEAR(on.height(i), before[i] - down, 2e-3) << int(level) << ", " << down << " m, " << i;
    }
}

// The lowest was moved out of it into those above, which slept on with it in them: hulls by up to 5 cm.
TEST(ManagerGround, WhatStandsOnGroundThatIsRaisedComesApart) {
  constexpr double kSide = StackOnShelf::kSide;
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables})
    for (const double up : {0.03, 0.1}) {
      StackOnShelf on(level);
      on.raise(up);
      double below = up;
      for (std::size_t i = 0; i < on.stack.size(); ++i) {
        const double bottom = on.height(i) - 0.5 * kSide;
        EXPECT_NEAR(bottom, below, 0.0125 * kSide) << int(level) << ", " << up << " m, " << i;
        EXPECT_TRUE(on.manager.asleep(on.stack[i])) << int(level);
        below = bottom + kSide;
      }
    }
}

// Without a velocity: a cube of `tables` came through a lift at .5 m/s, and through a ram at 1 m/s.
class GroundPutOn : public ::testing::TestWithParam<std::tuple<LevelChoice, double>> {
 protected:
  static constexpr double kSide = 0.4, kFrame = 1.0 / 60.0;  // m, s
  static constexpr int kFrames = 30;
  void put(int frame) { manager_.move_ground(lift_, testing::at({0, 0, speed_ * frame * kFrame - 0.1})); }
  void go(int first, int last) {
    for (int i = first; i <= last; ++i) put(i), manager_.step(kFrame);
  }
  double height_over_lift() const { return manager_.state(cube_).position.z() - speed_ * kFrames * kFrame; }

  LevelChoice level_ = std::get<0>(GetParam());
  double speed_ = std::get<1>(GetParam());  // m/s
  Manager manager_{{.signatures = coarse_signature}};
  GroundId lift_ = manager_.add_static_box({2, 2, 0.2}, {0, 0, -0.1}, Quat::Identity());
  BodyId cube_ = add(manager_, box_shape({kSide, kSide, kSide}), testing::at({0, 0, 0.5 * kSide}), level_);
};

TEST_P(GroundPutOn, CarriesWhatLiesOnIt) {
  run(manager_, 1.0);
  go(1, kFrames);
  EXPECT_NEAR(height_over_lift(), 0.5 * kSide, 0.15 * kSide) << "on its way";
  run(manager_, 2.0);
  EXPECT_NEAR(height_over_lift(), 0.5 * kSide, 2e-3);
  EXPECT_TRUE(manager_.asleep(cube_));
}

TEST_P(GroundPutOn, PushesWhatItComesAgainst) {
  manager_.add_plane(Vec3::UnitZ(), 0);
  const GroundId ram = manager_.add_static_box({0.2, 2, 2}, {-0.4, 0, 1.01}, Quat::Identity());
  run(manager_, 1.0);
  for (int i = 1; i <= kFrames; ++i) {
    const double front = speed_ * i * kFrame - 0.3;
    manager_.move_ground(ram, testing::at({front - 0.1, 0, 1.01}));
    manager_.step(kFrame);
    ASSERT_GT(manager_.state(cube_).position.x() - 0.5 * kSide, front - 0.05 * kSide) << i;
  }
}

TEST_P(GroundPutOn, GoesOnAlikeAfterARestore) {
  run(manager_, 1.0);
  go(1, 10);
  const std::vector<std::byte> then = manager_.snapshot();
  go(11, 13);
  const std::uint64_t hash = manager_.state_hash();
  put(10);
  manager_.restore(then);
  go(11, 13);
  EXPECT_EQ(manager_.state_hash(), hash);
}

// Its way in a step was compared with that in another of half the length; a step that is divided gave all of
// it to its first part.
TEST(ManagerGround, PutOnInStepsOfAnyLengthItCarriesWhatLiesOnIt) {
  constexpr double kSpeed = 1.0;  // m/s
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables})
    for (const double other : {1.0 / 30.0, 0.3}) {
      Manager manager({.signatures = coarse_signature});
      const GroundId platform = manager.add_static_box({6, 2, 0.2}, {0, 0, -0.1}, Quat::Identity());
      const BodyId cube = add(manager, box_shape({0.3, 0.3, 0.3}), testing::at({0, 0, 0.15}), level);
      double at = 0.0, slipped = 0.0;  // m
      const auto go = [&](double dt) {
        at += kSpeed * dt;
        manager.move_ground(platform, testing::at({at, 0, -0.1}));
        manager.step(dt);
      };
      for (int i = 0; i < 60; ++i) go(1.0 / 60.0);
      slipped = manager.state(cube).position.x() - at;
      for (int i = 0; i < 10; ++i) go(i % 2 == 0 ? other : 1.0 / 60.0);
      EXPECT_NEAR(manager.state(cube).position.x() - at, slipped, 0.01)
          << int(level) << ", " << other << " s";
      EXPECT_NEAR(manager.state(cube).velocity.x(), kSpeed, 0.05) << int(level) << ", " << other << " s";
    }
}

// Each part of a step that was divided began where the whole step did.
TEST(ManagerGround, ThroughAHitchALiftCarriesWhatLiesOnIt) {
  struct Case {
    LevelChoice level;
    bool with_velocity;
  };
  for (const Case c : {Case{LevelChoice::full, true},
                       {LevelChoice::support, true},
                       {LevelChoice::tables, true},
                       {LevelChoice::support, false},
                       {LevelChoice::tables, false}})
    for (const double speed : {1.0, 4.0}) {
      Manager manager({.signatures = coarse_signature});
      const GroundId lift = manager.add_static_box({3, 3, 0.2}, {0, 0, -0.1}, Quat::Identity());
      const BodyId cube = add(manager, box_shape({0.3, 0.3, 0.3}), testing::at({0, 0, 0.15}), c.level);
      double at = 0.0;  // m
      const auto go = [&](double dt) {
        if (!c.with_velocity) at += speed * dt;
        RigidState state = testing::at({0, 0, at - 0.1});
        if (c.with_velocity) state.velocity.z() = speed;
        manager.move_ground(lift, state);
        manager.step(dt);
        if (c.with_velocity) at += speed * dt;
      };
      for (int i = 0; i < 30; ++i) go(1.0 / 60.0);
      go(0.5);
      EXPECT_NEAR(manager.state(cube).position.z() - at, 0.15, 0.02)
          << int(c.level) << ", " << speed << " m/s";
      go(1.0 / 60.0);
      EXPECT_NEAR(manager.state(cube).position.z() - at, 0.15, 0.02)
          << int(c.level) << ", " << speed << " m/s";
    }
}

// What was put on for a step that was refused is put on for the next.
TEST(ManagerGround, ARefusedStepForgetsNothing) {
  const auto run = [](bool refused, bool with_velocity, double dt) {
    const Shape odd = *box_shape({0.31, 0.3, 0.3});
    const auto source = [&](const Shape& shape, const ContactLaw& law) {
      return shape.volume == odd.volume ? nullptr : coarse_signature(shape, law);
    };
    Manager manager({.signatures = source, .signature_timing = SignatureTiming::in_step});
    const GroundId slab = manager.add_static_box({6, 2, 0.2}, {0, 0, -0.1}, Quat::Identity());
    const BodyId cube =
        add(manager, box_shape({0.3, 0.3, 0.3}), testing::at({0, 0, 0.15}), LevelChoice::tables);
    double way = 0.0;  // m
    for (int i = 0; i < 30; ++i) {
      const double time = i == 20 ? dt : kFrame;
      RigidState state = testing::at({way, 0, -0.1});
      if (with_velocity) state.velocity.x() = 1.0;
      way += 1.0 * time;
      manager.move_ground(slab, state);
      if (refused && i == 20) {
        const BodyId bad =
            add(manager, std::make_shared<const Shape>(odd), testing::at({0, 0, 5}), LevelChoice::tables);
        EXPECT_THROW(manager.step(time), InputError);
        manager.remove_body(bad);
      }
      manager.step(time);
    }
    return manager.state(cube).position.x();
  };
  for (const bool with_velocity : {false, true})
    for (const double dt : {kFrame, 0.5})
      EXPECT_EQ(run(true, with_velocity, dt), run(false, with_velocity, dt)) << with_velocity << ' ' << dt;
}

INSTANTIATE_TEST_SUITE_P(All, GroundPutOn,
                         ::testing::Combine(::testing::Values(LevelChoice::full, LevelChoice::support,
                                                              LevelChoice::tables),
                                            ::testing::Values(0.5, 2.0)));

// Longer than a body may be: `support` stood on it, and who became full was lost with the step.
TEST(ManagerGround, AFloorOfManyKilometresHoldsOnEachRung) {
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables}) {
    Manager manager({.signatures = testing::coarse_signature});
    manager.add_static_box({20'000, 30'000, 2}, {0, 0, -1}, Quat::Identity());
    const BodyId body =
        testing::add(manager, testing::box_shape({0.4, 0.4, 0.4}), testing::at({70, 30, 0.3}), level);
    testing::run(manager, 2.0);
    EXPECT_NEAR(manager.state(body).position.z(), 0.2, 0.01) << int(level);
    EXPECT_TRUE(manager.asleep(body)) << int(level);
  }
}

// As games put it, in each frame.
TEST(ManagerGround, PutWhereItStandsWakesNobody) {
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::full}) {
    Manager manager(unmeasured());
    const GroundId table = manager.add_static_box({2, 2, 1}, {0, 0, -0.5}, Quat::Identity());
    const BodyId body = add(manager, box_shape({0.2, 0.2, 0.2}), at({0, 0, 0.1}), level);
    for (int i = 0; i < 120; ++i) {
      manager.move_ground(table, at({0, 0, -0.5}));
      manager.step(kFrame);
    }
    EXPECT_TRUE(manager.asleep(body));
    manager.move_ground(table, at({0, 0, -1}));
    run(manager, 0.2);
    EXPECT_FALSE(manager.asleep(body));
  }
}

}  // namespace
}  // namespace lodestone
