// Contacts between a full and a statistical body, and changes of level among bodies that touch: hard cases
// T4, T5, T6, T10.
#include <gtest/gtest.h>

#include <algorithm>

#include "reference/random.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone::cross_level_test {
namespace {

using namespace testing;

constexpr auto kFull = LevelChoice::full, kStatistical = LevelChoice::statistical;
constexpr double kSide = 0.4;

// The rest poses of a cube: what its statistical contacts need to know of it.
std::shared_ptr<const Signature> cube_signature(const Shape& shape, const ContactLaw&) {
  auto signature = std::make_shared<Signature>();
  signature->shape_hash = shape.content_hash;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0})
      signature->rest_poses.push_back({side * Vec3::Unit(axis), 1.0 / std::sqrt(3.0), 1.0 / 6.0});
  return signature;
}

ManagerSettings of_cubes() {
  ManagerSettings settings = unmeasured();
  settings.signatures = cube_signature;
  return settings;
}

std::vector<BodyId> add_stack(Manager& manager, std::span<const LevelChoice> levels, double offset = 0.0) {
  std::vector<BodyId> bodies;
  const auto cube = box_shape({kSide, kSide, kSide});
  for (std::size_t i = 0; i < levels.size(); ++i)
    bodies.push_back(
        add(manager, cube, at({i % 2 ? offset : 0.0, 0, (0.5 + double(i)) * (kSide + 5e-4)}), levels[i]));
  return bodies;
}

void expect_standing(const Manager& manager, std::span<const BodyId> stack, double tolerance) {
  for (std::size_t i = 0; i < stack.size(); ++i) {
    const RigidState state = manager.state(stack[i]);
    EXPECT_NEAR(state.position.z(), (0.5 + double(i)) * kSide, tolerance) << "body " << i;
    EXPECT_LT(state.velocity.norm(), 0.02) << "body " << i;
  }
}

TEST(CrossLevel, EachRestsOnTheOtherAndSleeps) {
  for (const auto& levels : {std::array{kFull, kStatistical}, std::array{kStatistical, kFull}})
    for (const double offset : {0.0, 0.05, 0.1, 0.15}) {
      Manager manager = on_floor(of_cubes());
      const auto stack = add_stack(manager, levels, offset);
      run(manager, 3.0);
      expect_standing(manager, stack, 0.002);
      EXPECT_NEAR(manager.state(stack[1]).position.x(), offset, 0.01);
      EXPECT_EQ(manager.report().asleep, 2);
    }
}

TEST(CrossLevel, MixedStackStands) {
  for (const auto& levels : {std::array{kFull, kStatistical, kFull, kStatistical},
                             std::array{kStatistical, kFull, kStatistical, kFull},
                             std::array{kFull, kFull, kStatistical, kStatistical},
                             std::array{kStatistical, kStatistical, kFull, kFull}}) {
    Manager manager = on_floor(of_cubes());
    const auto stack = add_stack(manager, levels);
    run(manager, 3.0);
    expect_standing(manager, stack, 0.01);
  }
}

TEST(CrossLevel, BodyBeyondTheEdgeFallsOff) {
  for (const auto& levels : {std::array{kFull, kStatistical}, std::array{kStatistical, kFull}}) {
    Manager manager = on_floor(of_cubes());
    const auto stack = add_stack(manager, levels, 0.25);
    run(manager, 2.0);
    EXPECT_LT(manager.state(stack[1]).position.z(), 0.3);
  }
}

TEST(CrossLevel, T4DemotedInMidSlideStopsWhereItWould) {
  Manager manager = on_floor(of_cubes());
  const auto slab = box_shape({0.4, 0.4, 0.1});
  const BodyId body = add(manager, slab, at({0, 0, 0.05}, {3, 0, 0}), kFull);
  run(manager, 0.15);
  manager.set_level(body, kStatistical);
  run(manager, 2.0);
  const double distance = 9.0 / (2.0 * 0.5 * kGravity);
  EXPECT_NEAR(manager.state(body).position.x(), distance, 0.15 * distance);
}

TEST(CrossLevel, T5DemotedBottomStillCarriesTheStack) {
  Manager manager = on_floor(of_cubes());
  const std::array levels{kFull, kFull, kFull, kFull, kFull};
  const auto stack = add_stack(manager, levels);
  run(manager, 0.5);
  const double top = manager.state(stack[4]).position.z();
  manager.set_level(stack[0], kStatistical);
  manager.step(kFrame);
  EXPECT_FALSE(manager.asleep(stack[1]));
  run(manager, 1.0);
  EXPECT_EQ(manager.level(stack[0]), Level::statistical);
  EXPECT_NEAR(manager.state(stack[4]).position.z(), top, 0.02);
}

TEST(CrossLevel, T5StackChangesLevelOneByOneAndStands) {
  Manager manager = on_floor(of_cubes());
  const std::array levels{kStatistical, kStatistical, kStatistical};
  const auto stack = add_stack(manager, levels);
  run(manager, 1.0);
  for (const LevelChoice level : {kFull, kStatistical})
    for (const int i : {1, 0, 2}) {
      manager.set_level(stack[i], level);
      run(manager, 0.4);
      EXPECT_EQ(manager.level(stack[i]), level == kFull ? Level::full : Level::statistical);
      for (std::size_t k = 0; k < stack.size(); ++k)
        EXPECT_NEAR(manager.state(stack[k]).position.z(), (0.5 + double(k)) * kSide, 0.01);
    }
  EXPECT_EQ(manager.report().counters.promotions_put_off, 0);
}

struct Momentum {
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
};

Momentum momentum_of(const Manager& manager, std::span<const BodyId> bodies) {
  Momentum sum;
  for (const BodyId body : bodies) {
    const RigidState s = manager.state(body);
    const double mass = manager.mass(body);
    sum.linear += mass * s.velocity;
    sum.angular += mass * s.position.cross(s.velocity) +
                   mass * (s.orientation * (manager.shape(body).inertia_per_mass *
                                            (s.orientation.conjugate() * s.angular_velocity)));
  }
  return sum;
}

struct Pair {
  RigidState first, second;
  Momentum before, after;
  bool met = false;
};

// Two cubes that fly into each other without gravity, turning at `spin` rad/s, until the frame in which they
// met.
Pair collide(LevelChoice first_level, LevelChoice second_level, std::uint32_t trial, double spin = 0.0) {
  RandomStream random(11, trial, 0);
  ManagerSettings settings = of_cubes();
  settings.gravity.setZero();
  Manager manager(settings);
  const auto cube = box_shape({kSide, kSide, kSide});
  const Vec3 off_axis = 0.15 * random.direction();
  RigidState first{{-0.6, 0, 0}, random.orientation(), {4, 0, 0}, spin * random.direction()};
  RigidState second{
      {0.6, off_axis.y(), off_axis.z()}, random.orientation(), {-4, 0, 0}, spin * random.direction()};
  const BodyId bodies[] = {
      manager.add_body({.shape = cube, .state = first, .mass = 2.0, .level = first_level}),
      manager.add_body({.shape = cube, .state = second, .mass = 3.0, .level = second_level})};
  Pair pair;
  pair.before = momentum_of(manager, bodies);
  for (int i = 0; i < 12 && !pair.met; ++i) {
    manager.step(kFrame);
    pair.met = (manager.state(bodies[0]).velocity - first.velocity).norm() > 1e-6;
  }
  pair.after = momentum_of(manager, bodies);
  pair.first = manager.state(bodies[0]);
  pair.second = manager.state(bodies[1]);
  return pair;
}

TEST(CrossLevel, T10MomentumIsKept) {
  for (std::uint32_t trial = 0; trial < 50; ++trial) {
    const Pair pair = collide(kFull, kStatistical, trial, 3.0);
    ASSERT_TRUE(pair.met);
    constexpr double kMeeting = 20.0;  // kg m/s
    EXPECT_LT((pair.after.linear - pair.before.linear).norm(), 1e-9 * kMeeting) << trial;
    EXPECT_LT((pair.after.angular - pair.before.angular).norm(), 1e-3 * kMeeting * kSide)
        << trial;  // overlap is undone by moving
  }
}

// A cube of a higher rung and three of `tables` that fly into each other, so that spheres among them lie
// between a hull and a sphere for several frames.
TEST(CrossLevel, T10AHullAmongSpheresKeepsMomentum) {
  const auto cube = box_shape({0.2, 0.2, 0.2});
  const auto signature = coarse_signature(*cube, {});
  for (const auto hull : {LevelChoice::support, kFull})
    for (std::uint32_t trial = 0; trial < 30; ++trial) {
      RandomStream random(12, trial, 0);
      ManagerSettings settings = unmeasured();
      settings.signatures = [&](const Shape&, const ContactLaw&) { return signature; };
      settings.gravity.setZero();
      Manager manager(settings);
      std::vector<BodyId> bodies;
      double scale = 0.0;  // kg m/s
      for (int k = 0; k < 4; ++k) {
        const Vec3 aside = 0.04 * random.direction(), place(0.3 * k + aside.x(), aside.y(), aside.z());
        const Vec3 inward(-1.5 * (place.x() - 0.45), 0.0, 0.0);
        bodies.push_back(
            manager.add_body({.shape = cube,
                              .state = {place, random.orientation(), inward + 0.2 * random.direction()},
                              .level = k == 0 ? hull : LevelChoice::tables}));
        scale += manager.mass(bodies.back()) * manager.state(bodies.back()).velocity.norm();
      }
      const Vec3 before = momentum_of(manager, bodies).linear;
      for (int i = 0; i < 40; ++i) {
        manager.step(kFrame);
        ASSERT_LT((momentum_of(manager, bodies).linear - before).norm(), 1e-6 * scale)
            << "trial " << trial << " frame " << i;
      }
    }
}

TEST(CrossLevel, T10SameOutcomeWithTheRolesSwapped) {
  constexpr int kTrials = 50;
  int same = 0;
  for (std::uint32_t trial = 0; trial < kTrials; ++trial) {
    const Pair one = collide(kFull, kStatistical, trial), other = collide(kStatistical, kFull, trial);
    ASSERT_TRUE(one.met && other.met);
    same += (one.first.velocity - other.first.velocity).norm() < 1e-9 &&
            (one.second.velocity - other.second.velocity).norm() < 1e-9 &&
            (one.first.angular_velocity - other.first.angular_velocity).norm() < 1e-8 &&
            (one.second.angular_velocity - other.second.angular_velocity).norm() < 1e-8;
  }
  EXPECT_EQ(same, kTrials);
}

TEST(CrossLevel, HitWakesASleeperOfTheOtherLevelAndATouchDoesNot) {
  for (const auto& [sleeping, moving] : {std::pair{kFull, kStatistical}, std::pair{kStatistical, kFull}})
    for (const double speed : {0.02, 3.0}) {
      ManagerSettings settings = of_cubes();
      Manager manager = on_floor(settings);
      manager.materials().replace(0, {.friction = 0.0});
      const auto cube = box_shape({kSide, kSide, kSide});
      const BodyId sleeper = add(manager, cube, at({0, 0, 0.5 * kSide}), sleeping);
      run(manager, 1.0);
      ASSERT_TRUE(manager.asleep(sleeper));
      add(manager, cube, at({1.02 * kSide, 0, 0.5 * kSide}, {-speed, 0, 0}), moving);
      bool woke = false;
      for (int i = 0; i < 40; ++i) {
        manager.step(kFrame);
        woke = woke || !manager.asleep(sleeper);
      }
      EXPECT_EQ(woke, speed > 1.0) << int(sleeping) << " " << speed;
    }
}

TEST(CrossLevel, T6PromotionInsideAPileDisturbsNobody) {
  Manager manager = on_floor(of_cubes());
  const auto cube = box_shape({0.2, 0.2, 0.2});
  std::vector<BodyId> bodies;
  for (std::uint32_t i = 0; i < 150; ++i) {
    RandomStream random(5, i, 0);
    const RigidState state{
        {0.3 * (i % 5) + 0.02 * random.uniform(), 0.3 * (i / 5 % 5), 0.4 + 0.36 * (i / 25)},
        random.orientation(),
        Vec3::Zero(),
        Vec3::Zero()};
    bodies.push_back(add(manager, cube, state, kStatistical));
  }
  for (int second = 0; second < 20 && manager.report().asleep < int(bodies.size()); ++second)
    run(manager, 1.0);
  ASSERT_EQ(manager.report().asleep, int(bodies.size()));
  const auto top_speed = [&](BodyId but) {
    double fastest = 0.0;
    for (const BodyId body : bodies)
      if (!(body == but)) fastest = std::max(fastest, manager.state(body).velocity.norm());
    return fastest;
  };
  int promoted = 0;
  double top = 0.0;  // m/s
  for (const int inside : {30, 60, 90, 120}) {
    manager.set_level(bodies[inside], kFull);
    for (int i = 0; i < 60; ++i) {
      manager.step(kFrame);
      top = std::max(top, top_speed(bodies[inside]));
    }
    promoted += manager.level(bodies[inside]) == Level::full;
  }
  EXPECT_GT(promoted, 0);
  EXPECT_LT(top, 0.05);
}

}  // namespace
}  // namespace lodestone::cross_level_test
