// What a caller does to a body: the same whichever rung it is on.
#include <gtest/gtest.h>

#include <map>

#include "reference/error.h"
#include "reference/random.h"
#include "tests/lod/manager/manager_fixture.h"
#include "tests/message_of.h"

namespace lodestone::manager_bodies_test {
namespace {

using namespace testing;

constexpr LevelChoice kRungsOf[] = {LevelChoice::support, LevelChoice::full};

Manager in_space() {
  ManagerSettings settings = unmeasured();
  settings.gravity = Vec3::Zero();
  return Manager(settings);
}

Vec3 spin_of_body(const Manager& manager, BodyId body) {
  const RigidState state = manager.state(body);
  const Shape& shape = manager.shape(body);
  return manager.mass(body) * (state.orientation * (shape.inertia_per_mass * (state.orientation.conjugate() *
                                                                              state.angular_velocity)));
}

// Linear and angular momentum change by just what an impulse at a point gives, at once.
TEST(ManagerBodies, AnImpulseGivesItsMomentumOnEveryRung) {
  RandomStream random(21, 0, 0);
  for (const LevelChoice level : kRungsOf)
    for (int i = 0; i < 20; ++i) {
      Manager manager = in_space();
      const BodyId body =
          add(manager, box_shape({0.2, 0.3, 0.5}),
              at({1, 2, 3}, random.direction(), random.direction(), random.orientation()), level);
      manager.step(kFrame);
      const RigidState before = manager.state(body);
      const Vec3 spin = spin_of_body(manager, body);
      const Vec3 impulse = random.uniform(0, 20) * random.direction(),
                 point = before.position + 0.2 * random.direction();
      manager.add_impulse(body, impulse, point);
      const RigidState after = manager.state(body);
      EXPECT_LT((manager.mass(body) * (after.velocity - before.velocity) - impulse).norm(), 1e-9);
      EXPECT_LT((spin_of_body(manager, body) - spin - (point - before.position).cross(impulse)).norm(), 1e-9);
      EXPECT_EQ(after.position, before.position);
      EXPECT_LT((after.orientation.coeffs() - before.orientation.coeffs()).norm(), 1e-15);
    }
}

// A crate at rest that is pushed harder than friction holds it slides as a rigid body does, and one that is
// pushed less stays: its settling clip knows nothing of the force.
TEST(ManagerBodies, AForceMovesWhatIsAtRest) {
  constexpr double kFriction = 0.5, kTime = 0.5;  // s
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables})
    for (const double share : {0.3, 0.9}) {  // of the weight
      Manager manager = on_floor({.signatures = coarse_signature});
      manager.materials().replace(0, {.restitution = 0.0, .friction = kFriction});
      const BodyId body = add(manager, box_shape({0.3, 0.3, 0.3}), testing::at({0, 0, 0.15}), level);
      run(manager, 2.0);
      const double before = manager.state(body).position.x();
      for (int i = 0; i < 30; ++i) {
        manager.add_force_at(body, {share * manager.mass(body) * 9.81, 0, 0},
                             manager.state(body).position - Vec3(0, 0, 0.05));
        manager.step(kFrame);
      }
      const double moved = manager.state(body).position.x() - before,
                   expected = 0.5 * std::max(0.0, share - kFriction) * 9.81 * kTime * kTime;
      EXPECT_NEAR(moved, expected, 0.25 * expected + 0.02) << int(level) << " at " << share;
    }
}

TEST(ManagerBodies, SetStateWakesWhatTheBodyIsPutInto) {
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables}) {
    Manager manager = on_floor({.signatures = coarse_signature});
    const auto cube = box_shape({0.3, 0.3, 0.3});
    const BodyId sleeper = add(manager, cube, testing::at({0, 0, 0.15}), level);
    const BodyId wall = manager.add_body({.shape = cube,
                                          .state = testing::at({3, 0, 0.15}),
                                          .level = level,
                                          .properties = {.kinematic = true}});
    run(manager, 2.0);
    ASSERT_TRUE(manager.asleep(sleeper));
    manager.set_state(wall, testing::at({0.28, 0, 0.15}));
    EXPECT_FALSE(manager.asleep(sleeper)) << int(level);
    run(manager, 2.0);
    EXPECT_LT(manager.state(sleeper).position.x(), -0.015) << int(level);
  }
}

// A sleeper falls when what bears it meets it no more, or bears it no more: at once, not when somebody else
// wakes it.
TEST(ManagerBodies, PropertiesOfWhatBearsASleeperWakeIt) {
  ManagerSettings settings = unmeasured();
  const auto cube = box_shape({0.2, 0.2, 0.2});
  std::map<double, std::shared_ptr<const Signature>> known;  // by volume
  settings.signatures = [&](const Shape& shape, const ContactLaw& law) {
    auto& signature = known[shape.volume];
    if (!signature) signature = coarse_signature(shape, law);
    return signature;
  };
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables})
    for (const bool released : {false, true})
      for (const double dt : {1.0 / 30, 1.0 / 75}) {
        Manager manager(settings);
        const LevelChoice shelf_level = level == LevelChoice::full ? level : LevelChoice::support;
        BodyProperties held;
        held.kinematic = true;
        const BodyId shelf = add(manager, box_shape({1, 1, 0.1}), at({0, 0, 1}), shelf_level),
                     sleeper = add(manager, cube, at({0.1, 0, 1.15}), level);
        manager.set_properties(shelf, held);
        for (double t = 0.0; t < 2.0; t += dt) manager.step(dt);
        ASSERT_TRUE(manager.asleep(sleeper));
        BodyProperties changed;
        if (!released) changed = held, changed.category = changed.collide = 0;
        manager.set_properties(shelf, changed);
        const int steps = int(0.2 / dt);
        for (int i = 0; i < steps; ++i) manager.step(dt);
        const double t = steps * dt;
        EXPECT_LT(manager.state(sleeper).position.z(), 1.15 - 0.8 * 0.5 * 9.81 * t * t) << released << dt;
      }
}

// One that bears its weight holds a body where it is; what moves by itself alone no force moves.
TEST(ManagerBodies, AForceInTheAirActsThroughTheWholeStep) {
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables}) {
    Manager manager = on_floor({.signatures = coarse_signature});
    const auto box = box_shape({0.3, 0.3, 0.3});
    const BodyId hovers = add(manager, box, testing::at({0, 0, 3}), level),
                 flies = add(manager, box, testing::at({5, 0, 3}), level);
    const BodyId lift = manager.add_body({.shape = box,
                                          .state = testing::at({0, 5, 3}, {0, 0, 0.5}),
                                          .level = level,
                                          .properties = {.kinematic = true}});
    for (int i = 0; i < 60; ++i) {
      for (const BodyId body : {hovers, flies, lift})
        manager.add_force(body,
                          {body == flies ? 3.0 * manager.mass(body) : 0.0, 0, manager.mass(body) * 9.81});
      manager.step(kFrame);
    }
    EXPECT_NEAR(manager.state(hovers).position.z(), 3.0, 0.025) << int(level);
    EXPECT_NEAR(manager.state(flies).position.x(), 5.0 + 0.5 * 3.0, 0.01) << int(level);
    EXPECT_NEAR(manager.state(lift).position.z(), 3.5, 1e-9) << int(level);
  }
}

TEST(ManagerBodies, AForceAtAPointIsAForceAndATorque) {
  for (const LevelChoice level : kRungsOf) {
    Manager one = in_space(), other = in_space();
    const auto box = box_shape({0.2, 0.3, 0.4});
    const BodyId a = add(one, box, at({1, 0, 0}), level), b = add(other, box, at({1, 0, 0}), level);
    one.step(kFrame), other.step(kFrame);
    one.add_force_at(a, {0, 5, 0}, {1.1, 0, 0.1});
    other.add_force(b, {0, 5, 0}, Vec3(0.1, 0, 0.1).cross(Vec3(0, 5, 0)));
    one.step(kFrame), other.step(kFrame);
    EXPECT_LT((one.state(a).velocity - other.state(b).velocity).norm(), 1e-12);
    EXPECT_LT((one.state(a).angular_velocity - other.state(b).angular_velocity).norm(), 1e-9);
    EXPECT_GT(one.state(a).angular_velocity.norm(), 1e-3);
    EXPECT_NEAR(one.state(a).velocity.y(), 5.0 * kFrame / one.mass(a), 1e-6);
  }
}

// Forces add up over a step, act in it once, and are gone.
TEST(ManagerBodies, ForcesAddUpForOneStep) {
  for (const LevelChoice level : kRungsOf) {
    Manager manager = in_space();
    const BodyId body = add(manager, box_shape({0.2, 0.2, 0.2}), at({0, 0, 0}), level);
    manager.step(kFrame);
    for (int i = 0; i < 3; ++i) manager.add_force(body, {2, 0, 0});
    manager.step(kFrame);
    const double speed = 6.0 * kFrame / manager.mass(body);
    EXPECT_NEAR(manager.state(body).velocity.x(), speed, 1e-6);
    manager.step(kFrame);
    EXPECT_NEAR(manager.state(body).velocity.x(), speed, 1e-6);
  }
}

TEST(ManagerBodies, AKinematicBodyTakesNoImpulse) {
  Manager manager = in_space();
  for (const LevelChoice level : kRungsOf) {
    BodyProperties driven;
    driven.kinematic = true, driven.max_angular_speed = 3.0;
    const BodyId body =
        manager.add_body({.shape = box_shape({0.2, 0.2, 0.2}),
                          .state = at({level == LevelChoice::full ? 0.0 : 5.0, 0, 0}, {1, 0, 0}),
                          .level = level,
                          .properties = driven});
    manager.step(kFrame);
    manager.add_impulse(body, {0, 100, 0}, manager.state(body).position);
    manager.step(kFrame);
    EXPECT_EQ(manager.state(body).velocity, Vec3(1, 0, 0));
  }
}

TEST(ManagerBodies, MassIsDensityTimesVolumeUnlessGiven) {
  Manager manager = in_space();
  const MaterialId cork = manager.materials().add({.density = 200.0});
  const auto box = box_shape({0.5, 0.4, 0.3});
  EXPECT_NEAR(manager.mass(manager.add_body({.shape = box})), 1000.0 * 0.06, 1e-9);
  EXPECT_NEAR(manager.mass(manager.add_body({.shape = box, .state = at({2, 0, 0}), .material = cork})),
              200.0 * 0.06, 1e-9);
  EXPECT_EQ(manager.mass(manager.add_body({.shape = box, .state = at({4, 0, 0}), .mass = 7.5})), 7.5);
}

// Sleeping by hand, in the air: it stays until something is done to it.
TEST(ManagerBodies, LaidToSleepItStaysUntilItIsWoken) {
  for (const LevelChoice level : kRungsOf) {
    Manager manager{unmeasured()};
    const BodyId body = add(manager, box_shape({0.2, 0.2, 0.2}), at({0, 0, 5}, {1, 0, 0}), level);
    manager.step(kFrame);
    const auto laid = [&] {
      manager.sleep(body);
      const RigidState before = manager.state(body);
      for (int i = 0; i < 5; ++i) manager.step(kFrame);
      EXPECT_TRUE(manager.asleep(body));
      EXPECT_EQ(manager.state(body).position, before.position);
      EXPECT_EQ(manager.state(body).velocity, Vec3(Vec3::Zero()));
    };
    const auto falls = [&] {
      const double height = manager.state(body).position.z();
      for (int i = 0; i < 5; ++i) manager.step(kFrame);
      EXPECT_FALSE(manager.asleep(body));
      EXPECT_LT(manager.state(body).position.z(), height);
    };
    laid(), manager.wake(body), falls();
    laid(), manager.add_force(body, {0, 0, 0.001}), falls();
    laid(), manager.add_impulse(body, {0, 0, -0.001}, manager.state(body).position), falls();
    laid(), manager.set_state(body, manager.state(body)), falls();
    laid(), manager.set_properties(body, {.linear_damping = 0.01}), falls();
  }
}

// A force that was given is dropped with the sleep.
TEST(ManagerBodies, SleepDropsTheForceOfTheNextStep) {
  for (const LevelChoice level : kRungsOf) {
    Manager manager = in_space();
    const BodyId body = add(manager, box_shape({0.2, 0.2, 0.2}), at({0, 0, 0}), level);
    manager.step(kFrame);
    manager.add_force(body, {100, 0, 0});
    manager.sleep(body);
    manager.wake(body);
    manager.step(kFrame);
    EXPECT_EQ(manager.state(body).velocity, Vec3(Vec3::Zero()));
  }
}

// Random adding, removing and moving against a plain list of what there is.
TEST(ManagerBodies, BodiesAreThoseThatWereAddedAndNotRemoved) {
  Manager manager = in_space();
  const auto box = box_shape({0.1, 0.1, 0.1});
  std::vector<std::pair<BodyId, RigidState>> there;
  std::vector<BodyId> gone;
  RandomStream random(22, 0, 0);
  double next_x = 0.0;
  for (int i = 0; i < 300; ++i) {
    const double what = random.uniform();
    if (what < 0.5 || there.empty()) {
      const RigidState state = at({next_x += 1.0, 0, 0});
      const BodyId body = add(manager, box, state, kRungsOf[i % 2]);
      for (const auto& [other, unused] : there) EXPECT_FALSE(other == body);
      for (const BodyId other : gone) EXPECT_FALSE(other == body);
      there.emplace_back(body, state);
    } else {
      const auto which = std::size_t(random.uniform(0.0, double(there.size())));
      if (what < 0.75) {
        manager.remove_body(there[which].first);
        gone.push_back(there[which].first);
        there.erase(there.begin() + std::ptrdiff_t(which));
      } else {
        there[which].second = at({next_x += 1.0, 1, 0});
        manager.set_state(there[which].first, there[which].second);
      }
    }
    if (i % 10 == 0) manager.step(kFrame);
    ASSERT_EQ(manager.bodies(), int(there.size()));
  }
  for (const auto& [body, state] : there) {
    EXPECT_TRUE(manager.valid(body));
    EXPECT_LT((manager.state(body).position - state.position).norm(), 1e-6);
  }
  for (const BodyId body : gone) {
    EXPECT_FALSE(manager.valid(body));
    EXPECT_THROW(manager.state(body), InputError);
  }
}

TEST(ManagerBodies, UserDataStaysWithTheBody) {
  Manager manager = in_space();
  const auto box = box_shape({0.1, 0.1, 0.1});
  const BodyId a = manager.add_body({.shape = box, .user_data = 17}), b = add(manager, box, at({1, 0, 0}));
  EXPECT_EQ(manager.user_data(a), 17U);
  EXPECT_EQ(manager.user_data(b), 0U);
  manager.set_user_data(b, 4);
  manager.set_level(b, LevelChoice::full);
  manager.step(kFrame);
  manager.remove_body(a);
  manager.step(kFrame);
  EXPECT_EQ(manager.user_data(b), 4U);
  const BodyId c = add(manager, box, at({2, 0, 0}));  // in a's place
  EXPECT_EQ(manager.user_data(c), 0U);
}

// Half of the velocity is gone after ln 2 over the damping.
TEST(ManagerBodies, DampingIsExponentialOnEveryRung) {
  for (const LevelChoice level : kRungsOf) {
    Manager manager = in_space();
    const BodyId body = manager.add_body({.shape = sphere_shape(0.2),
                                          .state = at({0, 0, 0}, {2, 0, 0}, {0, 4, 0}),
                                          .level = level,
                                          .properties = {.linear_damping = 2.0, .angular_damping = 1.0}});
    run(manager, 0.5);
    EXPECT_NEAR(manager.state(body).velocity.x(), 2.0 * std::exp(-1.0), 2e-3);
    EXPECT_NEAR(manager.state(body).angular_velocity.y(), 4.0 * std::exp(-0.5), 4e-3);
  }
}

TEST(ManagerBodies, WhatIsKinematicIsNeitherDampedNorHeldBack) {
  for (const LevelChoice level : kRungsOf) {
    Manager manager = in_space();
    const BodyProperties damped{.linear_damping = 2.0, .angular_damping = 1.0};
    const BodyId body = manager.add_body({.shape = sphere_shape(0.2),
                                          .state = at({0, 0, 0}, {2, 0, 0}, {0, 4, 0}),
                                          .level = level,
                                          .properties = damped});
    run(manager, 0.5);
    BodyProperties driven = damped;
    driven.kinematic = true, driven.max_angular_speed = 3.0;
    manager.set_properties(body, driven);
    manager.set_state(body, at({0, 0, 0}, {2, 0, 0}, {0, 4, 0}));
    run(manager, 0.5);
    EXPECT_NEAR(manager.state(body).position.x(), 1.0, 1e-6);
    EXPECT_NEAR(manager.state(body).velocity.x(), 2.0, 1e-12);
    EXPECT_NEAR(manager.state(body).angular_velocity.y(), 4.0, 1e-12);
  }
}

// One for whom the source has no other since a plane of another material is there: it keeps what it moves by.
TEST(ManagerBodies, PropertiesAreSetUnderALawThatIsNotMeasured) {
  double measured = -1.0;  // friction
  Manager manager(
      {.signatures = [&](const Shape& shape, const ContactLaw& law) -> std::shared_ptr<const Signature> {
        if (measured < 0.0) measured = law.friction;
        if (law.friction != measured) throw InputError("of no other ground");
        return coarse_signature(shape, law);
      }});
  const MaterialId ice = manager.materials().add({.friction = 0.0});
  const GroundId floor = manager.add_plane(Vec3::UnitZ(), 0.0);
  const BodyId body = add(manager, box_shape({0.2, 0.3, 0.4}), at({0, 0, 0.5}), LevelChoice::tables);
  run(manager, 1.0);
  ASSERT_EQ(manager.rung(body), Rung::tables);
  manager.remove_ground(floor);
  manager.add_plane(Vec3::UnitZ(), 0.0, ice);
  manager.set_properties(body, {.linear_damping = 0.1});
  EXPECT_EQ(manager.rung(body), Rung::support);
  run(manager, 0.5);
  EXPECT_NEAR(manager.state(body).position.z(), 0.2, 0.1);
  manager.set_properties(body, {});
  run(manager, 0.1);
  EXPECT_EQ(manager.rung(body), Rung::tables);
}

}  // namespace
}  // namespace lodestone::manager_bodies_test
