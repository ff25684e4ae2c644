// The public face of the engine: bodies, ids, counters, validation, a caller's own world.
#include "lod/manager.h"

#include <gtest/gtest.h>
#include <ode/ode.h>

#include <limits>
#include <map>
#include <thread>

#include "reference/error.h"
#include "signature/measure/measure.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone::manager_test {
namespace {

using namespace testing;

const Vec3 kSides{0.2, 0.3, 0.4};

TEST(Manager, FullBodyFallsAndComesToRest) {
  Manager manager = on_floor();
  const BodyId box = add(manager, box_shape(kSides), at({0, 0, 0.5}), LevelChoice::full);
  run(manager, 3.0);
  EXPECT_NEAR(manager.state(box).position.z(), 0.2, 1e-3);
  EXPECT_TRUE(manager.asleep(box));
  EXPECT_EQ(manager.report().full, 1);
  EXPECT_EQ(manager.report().asleep, 1);
  EXPECT_EQ(manager.report().step, 180);
}

TEST(Manager, SleepCanBeOff) {
  ManagerSettings settings = unmeasured();
  settings.sleeping = false;
  Manager manager = on_floor(settings);
  add(manager, box_shape(kSides), at({0, 0, 0.21}), LevelChoice::full);
  add(manager, box_shape(kSides), at({3, 0, 0.21}), LevelChoice::statistical);
  run(manager, 3.0);
  EXPECT_EQ(manager.report().asleep, 0);
}

TEST(Manager, AllFullSceneAsksForNoSignatureAndHasNoPairPhase) {
  int asked = 0;
  ManagerSettings settings = unmeasured();
  settings.signatures = [&](const Shape&, const ContactLaw&) { return ++asked, nullptr; };
  Manager manager = on_floor(settings);
  const auto shape = box_shape(kSides);
  for (int i = 0; i < 4; ++i) add(manager, shape, at({0.1 * i, 0, 0.3 + 0.5 * i}), LevelChoice::full);
  run(manager, 0.5);
  EXPECT_EQ(asked, 0);
  EXPECT_EQ(manager.report().statistical, 0);
  EXPECT_EQ(manager.report().counters.signatures_loaded, 0);
  EXPECT_EQ(manager.report().counters.pair_phases, 0);
  EXPECT_EQ(manager.report().counters.ode_bodies_created, 4);
  EXPECT_EQ(manager.report().counters.trimeshes_built, 1);
}

TEST(Manager, AllStatisticalSceneMakesNothingInOde) {
  Manager manager = on_floor();
  add(manager, box_shape(kSides), at({0, 0, 0.5}));
  add(manager, box_shape(kSides), at({1, 0, 0.5}), LevelChoice::statistical);
  run(manager, 0.5);
  EXPECT_EQ(manager.report().full, 0);
  EXPECT_EQ(manager.report().statistical, 2);
  EXPECT_EQ(manager.report().counters.ode_bodies_created, 0);
  EXPECT_EQ(manager.report().counters.trimeshes_built, 0);
}

// What is remembered of a pair goes by the bodies' indices: a body that took the place of another between two
// steps was looked for at the other's vertices.
TEST(Manager, ABodyInAnothersPlaceIsAnotherBody) {
  const auto round = std::make_shared<const Shape>(make_shape("round", make_sphere(0.2, 2)));
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::full}) {
    Manager manager = on_floor();
    const BodyId beside = add(manager, round, at({0, 0, 0.19}), LevelChoice::support);
    BodyId body = add(manager, round, at({0.41, 0, 0.19}), LevelChoice::support);
    for (int i = 0; i < 4; ++i) {
      run(manager, 2 * kFrame);
      const BodyId before = body;
      manager.remove_body(body);
      body = add(manager, i % 2 == 0 ? box_shape({0.3, 0.3, 0.3}) : round, at({0.41, 0, 0.19}),
                 i % 2 == 0 ? level : LevelChoice::support);
      EXPECT_NE(body.index, before.index);
    }
    EXPECT_TRUE(manager.state(beside).position.allFinite());
    run(manager, kFrame);
    EXPECT_LT(add(manager, round, at({3, 0, 1})).index, 6u);  // they are given again
  }
}

TEST(Manager, OneBodyHasNoPairPhase) {
  Manager manager = on_floor();
  add(manager, box_shape(kSides), at({0, 0, 0.5}));
  run(manager, 0.5);
  EXPECT_EQ(manager.report().counters.pair_phases, 0);
}

TEST(Manager, SignatureIsAskedForOncePerShapeAndLawWithTheGround) {
  std::map<std::pair<std::uint64_t, double>, int> asked;
  ManagerSettings settings = unmeasured();
  settings.signatures = [&](const Shape& shape, const ContactLaw& law) {
    ++asked[{shape.content_hash, law.friction}];
    auto signature = std::make_shared<Signature>();
    signature->shape_hash = shape.content_hash;
    return std::shared_ptr<const Signature>(std::move(signature));
  };
  Manager manager(settings);
  const MaterialId ground = manager.materials().add({.friction = 0.9});
  const MaterialId ice = manager.materials().add({.friction = 0.1});
  manager.add_plane(Vec3::UnitZ(), 0.0, ground);
  manager.add_plane(Vec3::UnitX(), -50.0);
  const auto box = box_shape(kSides), scaled = box_shape(2.0 * kSides), ball = sphere_shape(0.1);
  for (int i = 0; i < 3; ++i) add(manager, box, at({2.0 * i, 0, 5}));
  add(manager, scaled, at({0, 5, 5}));
  add(manager, ball, at({0, -5, 5}));
  manager.add_body({.shape = box, .state = at({9, 9, 5}), .material = ice});
  manager.step(kFrame);
  EXPECT_EQ(asked.size(), 3u);
  for (const auto& [key, times] : asked) EXPECT_EQ(times, 1);
  EXPECT_EQ((asked[{box->content_hash, std::sqrt(0.5 * 0.9)}]), 1);
  EXPECT_EQ((asked[{box->content_hash, std::sqrt(0.1 * 0.9)}]), 1);
  EXPECT_EQ(manager.report().counters.signatures_loaded, 3);
}

TEST(Manager, NewBodiesTakeTheirLevelAtOnceAndAreNoTransitions) {
  Manager manager = on_floor();
  view_from(manager, {0, 0, 0});
  const auto shape = sphere_shape(0.1);
  std::vector<BodyId> bodies;
  for (int i = 0; i < 20; ++i) bodies.push_back(add(manager, shape, at({0.5 * i, 0, 0.5})));
  EXPECT_EQ(manager.why(bodies[0]), "at no level yet: the next step chooses one");
  EXPECT_TRUE(same_bits(manager.state(bodies[3]), at({1.5, 0, 0.5})));
  manager.step(kFrame);
  EXPECT_EQ(manager.report().full, 9);  // 0 to 4 m, measured to the surface
  EXPECT_EQ(manager.report().statistical, 11);
  EXPECT_EQ(manager.report().promotions + manager.report().demotions, 0);
  EXPECT_EQ(manager.why(bodies[0]), "full: near a viewpoint");
  EXPECT_EQ(manager.why(bodies[19]), "support: far from every viewpoint");
}

TEST(Manager, ForcedFullBodyIsInOdeAtOnce) {
  Manager manager = on_floor();
  const BodyId full = add(manager, box_shape(kSides), at({0, 0, 1}), LevelChoice::full);
  const BodyId statistical = add(manager, box_shape(kSides), at({1, 0, 1}), LevelChoice::statistical);
  EXPECT_NE(manager.ode_body(full), nullptr);
  EXPECT_EQ(manager.level(full), Level::full);
  EXPECT_EQ(manager.ode_body(statistical), nullptr);
  manager.set_level(full, LevelChoice::statistical);
  manager.step(kFrame);
  EXPECT_EQ(manager.level(full), Level::statistical);
  EXPECT_EQ(manager.ode_body(full), nullptr);
  EXPECT_EQ(manager.why(full), "support: the caller chose this level");
}

TEST(Manager, RemovedBodysIdIsNeverValidAgain) {
  Manager manager = on_floor();
  const auto shape = sphere_shape(0.1);
  EXPECT_FALSE(manager.valid(BodyId{}));
  const BodyId first = add(manager, shape, at({0, 0, 1}), LevelChoice::full);
  manager.remove_body(first);
  EXPECT_FALSE(manager.valid(first));
  manager.step(kFrame);  // an index is given again after a step without its body
  const BodyId second = add(manager, shape, at({0, 0, 1}));
  EXPECT_EQ(second.index, first.index);
  EXPECT_FALSE(manager.valid(first));
  EXPECT_TRUE(manager.valid(second));
  EXPECT_THROW(manager.state(first), InputError);
}

// Slots of the statistical level move when one is freed; ids must not notice.
TEST(Manager, RemovalLeavesTheOtherBodiesAsTheyWere) {
  Manager manager = on_floor();
  const auto shape = sphere_shape(0.1);
  std::vector<BodyId> bodies;
  for (int i = 0; i < 12; ++i)
    bodies.push_back(
        add(manager, shape, at({1.0 * i, 0, 5}), i % 3 ? LevelChoice::statistical : LevelChoice::full));
  manager.step(kFrame);
  for (const int gone : {1, 0, 11, 4, 6}) manager.remove_body(bodies[gone]);
  manager.add_force(bodies[2], {0, 0, 1});
  manager.step(kFrame);
  EXPECT_EQ(manager.bodies(), 7);
  for (const int kept : {2, 3, 5, 7, 8, 9, 10}) EXPECT_EQ(manager.state(bodies[kept]).position.x(), kept);
}

TEST(Manager, RemovalBeforeTheFirstStep) {
  Manager manager = on_floor();
  const BodyId body = add(manager, sphere_shape(0.1), at({0, 0, 1}));
  manager.add_force(body, {1, 0, 0});
  manager.remove_body(body);
  manager.step(kFrame);
  EXPECT_EQ(manager.report().full + manager.report().statistical, 0);
}

TEST(Manager, ForceActsOverOneStepAtEveryLevel) {
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::statistical}) {
    ManagerSettings settings = unmeasured();
    settings.gravity.setZero();
    Manager manager(settings);
    const BodyId body =
        manager.add_body({.shape = sphere_shape(0.1), .state = at({0, 0, 0}), .mass = 2.0, .level = level});
    manager.add_force(body, {12, 0, 0});
    manager.add_force(body, {12, 0, 0});
    manager.step(kFrame);
    manager.step(kFrame);
    EXPECT_NEAR(manager.state(body).velocity.x(), 12 * kFrame, 1e-12);
  }
}

TEST(Manager, SetStateWakesTheBody) {
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::statistical}) {
    Manager manager = on_floor();
    const BodyId body = add(manager, box_shape(kSides), at({0, 0, 0.2}), level);
    run(manager, 2.0);
    ASSERT_TRUE(manager.asleep(body));
    manager.set_state(body, at({0, 0, 3}));
    EXPECT_FALSE(manager.asleep(body));
    run(manager, 0.2);
    EXPECT_LT(manager.state(body).position.z(), 2.9);
  }
}

TEST(Manager, SetStateOfASupportWakesWhatRestsOnIt) {
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::statistical}) {
    Manager manager = on_floor();
    const auto shape = box_shape({0.4, 0.4, 0.4});
    const BodyId lower = add(manager, shape, at({0, 0, 0.2}), level),
                 upper = add(manager, shape, at({0, 0, 0.6}), level);
    run(manager, 2.0);
    manager.set_state(lower, at({5, 0, 0.2}));
    run(manager, 1.0);
    EXPECT_LT(manager.state(upper).position.z(), 0.25);
  }
}

// Without viewpoints nobody looks where bodies are; once there is one, it counts where they are now.
TEST(Manager, ABodyThatNobodyFollowedIsPromotedWhereItIs) {
  ManagerSettings settings = unmeasured();
  Manager manager = on_floor(settings);
  RigidState thrown = at({0, 0, 3});
  thrown.velocity = {20, 0, 3};
  const BodyId body = add(manager, box_shape(kSides), thrown);
  run(manager, 1.0);
  const Vec3 now = manager.state(body).position;
  ASSERT_GT(now.x(), 15.0);
  manager.set_viewpoints(std::array{Vec3(0, 0, 3)});
  manager.step(1.0 / 60);
  EXPECT_EQ(manager.level(body), Level::statistical);
  manager.set_viewpoints(std::array{now});
  manager.step(1.0 / 60);
  EXPECT_EQ(manager.level(body), Level::full);
}

TEST(Manager, TheDwellGoesOnWhileNothingChanges) {
  Manager manager = on_floor();
  const BodyId body = add(manager, box_shape(kSides), at({0, 0, 0.2}));
  const auto look = [&](std::vector<Vec3> from, int steps) {
    manager.set_viewpoints(from);
    for (int i = 0; i < steps; ++i) manager.step(1.0 / 60);
    return manager.level(body);
  };
  ASSERT_EQ(look({Vec3(0, 0, 1)}, 40), Level::full);
  ASSERT_EQ(look({}, 10), Level::statistical);
  EXPECT_EQ(look({Vec3(0, 0, 1)}, 1), Level::statistical);  // it changed too recently
  EXPECT_EQ(look({}, 30), Level::statistical);
  EXPECT_EQ(look({Vec3(0, 0, 1)}, 1), Level::full);
}

TEST(Manager, OrientationIsNormalized) {
  Manager manager = on_floor();
  RigidState state = at({0, 0, 1});
  state.orientation.coeffs() *= 1.0 + 5e-7;
  const BodyId body = add(manager, sphere_shape(0.1), state);
  EXPECT_NEAR(manager.state(body).orientation.norm(), 1.0, 1e-15);
}

TEST(Manager, SleeperInTheWayOfANewStaticBoxWakesAndGetsOut) {
  Manager manager = on_floor();
  const BodyId near = add(manager, box_shape(kSides), at({0, 0, 0.2})),
               apart = add(manager, box_shape(kSides), at({9, 0, 0.2}));
  run(manager, 2.0);
  ASSERT_TRUE(manager.asleep(near));
  manager.add_static_box({1, 1, 1}, {0.55, 0, 0.5}, Quat::Identity());
  EXPECT_FALSE(manager.asleep(near));
  EXPECT_TRUE(manager.asleep(apart));
  run(manager, 2.0);
  EXPECT_EQ(manager.level(near), Level::statistical);
  EXPECT_LT(manager.state(near).position.x() + 0.5 * kSides.x() - 0.05, 0.02);  // it was .05 m inside
}

std::uint64_t hash_of_a_mixed_run() {
  Manager manager = on_floor();
  const auto shape = box_shape(kSides);
  for (int i = 0; i < 30; ++i) add(manager, shape, at({0.4 * (i % 6), 0.4 * (i / 6), 0.4 + 0.05 * i}));
  for (int i = 0; i < 90; ++i) {
    view_from(manager, {0.1 * i - 4.0, 0, 0});
    manager.step(kFrame);
  }
  return manager.state_hash();
}

TEST(Manager, SameRunGivesTheSameHash) { EXPECT_EQ(hash_of_a_mixed_run(), hash_of_a_mixed_run()); }

// A heap under either model, with an engine's own jobs: last task first, on a thread of its own.
std::uint64_t hash_of_a_heap(StatisticalModel model, const JobRunner& jobs) {
  ManagerSettings settings = unmeasured();
  settings.model = model;
  settings.signatures = [](const Shape& shape, const ContactLaw&) {
    SignatureSettings coarse;
    coarse.n_theta = 4, coarse.n_phi = 4, coarse.n_alpha = 6, coarse.trials_per_cell = 8,
    coarse.height_trials = 100, coarse.settling_trials = 20, coarse.clips = 10;
    return std::make_shared<const Signature>(measure_signature(shape, coarse, 1));
  };
  settings.threads = 2;
  settings.jobs = jobs;
  Manager manager = on_floor(settings);
  const auto shape = box_shape(kSides);
  for (int i = 0; i < 1'200; ++i)
    add(manager, shape, at({0.5 * (i % 20), 0.5 * (i / 20 % 20), 0.4 + 0.5 * (i / 400)}),
        LevelChoice::statistical);
  run(manager, 0.5);
  return manager.state_hash();
}

TEST(Manager, AnEnginesOwnJobsGiveTheSameHash) {
  for (const StatisticalModel model : {StatisticalModel::tables, StatisticalModel::support}) {
    std::int64_t tasks = 0;
    const JobRunner jobs = [&](std::int64_t count, TaskRef task) {
      tasks += count;
      std::thread([&] {
        for (std::int64_t i = count; i-- > 0;) task(i);
      }).join();
    };
    EXPECT_EQ(hash_of_a_heap(model, jobs), hash_of_a_heap(model, {})) << int(model);
    EXPECT_GT(tasks, 100) << int(model);
  }
}

// Before any task and after half of them, in all kinds of stages: the step is taken as if it had not thrown.
TEST(Manager, WhatAnEnginesOwnJobsThrowComesOutOfTheWholeStep) {
  const auto hash_where_every = [](std::int64_t throwing, int& thrown) {
    std::int64_t calls = 0;
    ManagerSettings settings = unmeasured();
    settings.jobs = [&](std::int64_t count, TaskRef task) {
      const bool throws = throwing > 0 && ++calls % throwing == 0;
      for (std::int64_t i = 0; i < count; ++i) {
        if (throws && i == count / 2 * (calls % 2)) throw std::runtime_error("no thread is free");
        task(i);
      }
    };
    Manager manager = on_floor(settings);
    const auto shape = box_shape(kSides);
    for (int i = 0; i < 200; ++i)
      add(manager, shape, at({0.5 * (i % 8), 0.5 * (i / 8 % 8), 0.3 + 0.3 * (i / 64)}),
          LevelChoice::statistical);
    for (int i = 0; i < 30; ++i) {
      try {
        manager.step(kFrame);
      } catch (const std::runtime_error&) {
        ++thrown;
      }
    }
    return manager.state_hash();
  };
  int none = 0;
  const std::uint64_t expected = hash_where_every(0, none);
  for (const std::int64_t throwing : {7, 31, 100}) {
    int thrown = 0;
    EXPECT_EQ(hash_where_every(throwing, thrown), expected) << throwing;
    EXPECT_GT(thrown, 1) << throwing;
  }
}

TEST(Manager, HashSeesStateAndLevel) {
  Manager manager = on_floor();
  const BodyId body = add(manager, sphere_shape(0.1), at({0, 0, 1}));
  manager.step(kFrame);
  const std::uint64_t before = manager.state_hash();
  RigidState state = manager.state(body);
  state.position.x() = std::nextafter(state.position.x(), 1.0);
  manager.set_state(body, state);
  EXPECT_NE(manager.state_hash(), before);
}

// A caller's world with a floor of its own and a body of its own.
class CallersWorld : public ::testing::Test {
 protected:
  CallersWorld() {
    dInitODE2(0);
    dAllocateODEDataForThread(dAllocateMaskAll);
    world = dWorldCreate();
    dWorldSetGravity(world, 0, 0, -1.6);
    space = dHashSpaceCreate(nullptr);
    dCreatePlane(space, 0, 0, 1, 0.5);
  }
  ~CallersWorld() override {
    dSpaceDestroy(space);
    dWorldDestroy(world);
  }
  dWorldID world;
  dSpaceID space;
};

TEST_F(CallersWorld, ItsPlaneAndGravityHoldAtBothLevels) {
  Manager manager(world, space, unmeasured());
  const BodyId full = add(manager, sphere_shape(0.1), at({0, 0, 2.0}), LevelChoice::full);
  const BodyId statistical = add(manager, sphere_shape(0.1), at({3, 0, 2.0}), LevelChoice::statistical);
  run(manager, 0.5);
  for (const BodyId body : {full, statistical}) EXPECT_NEAR(manager.state(body).velocity.z(), -0.8, 1e-9);
  run(manager, 8.0);
  for (const BodyId body : {full, statistical}) EXPECT_NEAR(manager.state(body).position.z(), 0.6, 2e-3);
}

TEST_F(CallersWorld, ItsOwnBodiesAreStepped) {
  const dBodyID mine = dBodyCreate(world);
  dBodySetPosition(mine, 9, 9, 9);
  Manager manager(world, space, unmeasured());
  run(manager, 0.5);
  EXPECT_NEAR(dBodyGetLinearVel(mine)[2], -0.8, 1e-9);
}

TEST_F(CallersWorld, PlanesAddedLaterCount) {
  Manager manager(world, space, unmeasured());
  const BodyId body = add(manager, sphere_shape(0.1), at({0, 0, 3.0}), LevelChoice::statistical);
  manager.step(kFrame);
  dCreatePlane(space, 0, 0, 1, 2.0);
  manager.add_plane(Vec3::UnitX(), -5.0);
  run(manager, 5.0);
  EXPECT_NEAR(manager.state(body).position.z(), 2.1, 2e-3);
}

TEST_F(CallersWorld, IsLeftAsItWas) {
  const int geoms = dSpaceGetNumGeoms(space);
  {
    Manager manager(world, space, unmeasured());
    add(manager, box_shape(kSides), at({0, 0, 2.0}), LevelChoice::full);
    manager.step(kFrame);
  }
  EXPECT_EQ(dSpaceGetNumGeoms(space), geoms);
}

// A ball that goes farther in a step than it is wide stops at a plane as a box does.
TEST(Manager, AFastFullBallDoesNotGoThroughThePlane) {
  constexpr double kRadius = 0.15;  // m
  const auto ball = std::make_shared<const Shape>(make_sphere_shape(kRadius));
  for (const double speed : {10.0, 20.0})
    for (const double frame : {1.0 / 60, 1.0 / 30}) {
      ManagerSettings settings = unmeasured();
      settings.full_substeps = 1;
      Manager manager = on_floor(settings);
      std::vector<BodyId> balls;
      for (int i = 0; i < 8; ++i)
        balls.push_back(add(manager, ball, testing::at({double(i), 0, 1.0 + 0.04 * i}, {0, 0, -speed}),
                            LevelChoice::full));
      for (int i = 0; i < int(2.0 / frame); ++i) {
        manager.step(frame);
        for (const BodyId body : balls)
          ASSERT_GT(manager.state(body).position.z(), 0.5 * kRadius) << speed << " m/s, " << frame << " s";
      }
    }
}

}  // namespace
}  // namespace lodestone::manager_test
