// What a caller passes at run time and cannot be used: named, and nothing has changed (F15, F17).
#include <gtest/gtest.h>
#include <ode/ode.h>

#include <functional>
#include <limits>

#include "reference/error.h"
#include "tests/lod/callers/callers_scene.h"
#include "tests/lod/manager/manager_fixture.h"
#include "tests/message_of.h"

namespace lodestone::bad_input_test {
namespace {

using namespace testing;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(),
                 kInfinity = std::numeric_limits<double>::infinity();

// Bodies on both levels, in flight.
struct Scene {
  Manager manager = on_floor();
  std::shared_ptr<const Shape> shape = box_shape({0.2, 0.3, 0.4});
  BodyId full = add(manager, shape, at({0, 0, 1}), LevelChoice::full),
         support = add(manager, shape, at({2, 0, 1}), LevelChoice::support),
         gone = add(manager, shape, at({4, 0, 1}));
  Scene() {
    run(manager, 0.1);
    manager.remove_body(gone);
  }

  void refuses(const std::function<void()>& act, const std::string& found, const std::string& expected) {
    const std::uint64_t before = manager.state_hash();
    const std::int64_t step = manager.report().step;
    const std::string message = message_of(act);
    EXPECT_NE(message.find("found " + found), std::string::npos) << message;
    EXPECT_NE(message.find("expected " + expected), std::string::npos) << message;
    EXPECT_EQ(manager.state_hash(), before) << message;
    EXPECT_EQ(manager.report().step, step) << message;
    EXPECT_EQ(manager.bodies(), 2) << message;
  }
};

TEST(BadInput, Steps) {
  Scene scene;
  for (const double dt : {-0.01, 10.5, kNan, kInfinity, -kInfinity})
    scene.refuses([&] { scene.manager.step(dt); }, "", "0 … 10 s");
  for (const double dt : {5e-324, 1e-100})
    scene.refuses([&] { scene.manager.step(dt); }, "", "0, or 1e-09 s or more");
}

TEST(BadInput, LevelsAndRungsThatAreNone) {
  Scene scene;
  Manager& manager = scene.manager;
  scene.refuses([&] { manager.set_level(scene.full, LevelChoice(17)); }, "17", "0 … 4");
  scene.refuses([&] { manager.set_rung_range(scene.full, Rung(9), Rung(9)); }, "9", "0 … 2");
  scene.refuses([&] { add(manager, scene.shape, at({6, 0, 1}), LevelChoice(5)); }, "5", "0 … 4");
}

TEST(BadInput, StaleIds) {
  Scene scene;
  Manager& manager = scene.manager;
  EXPECT_FALSE(manager.valid(scene.gone));
  for (const BodyId id : {scene.gone, BodyId{}, BodyId{77, 1}, BodyId{0, 9}}) {
    const std::function<void()> all[] = {[&] { manager.state(id); },
                                         [&] { manager.mass(id); },
                                         [&] { manager.rung(id); },
                                         [&] { manager.why(id); },
                                         [&] { manager.asleep(id); },
                                         [&] { manager.ode_body(id); },
                                         [&] { manager.shape(id); },
                                         [&] { manager.user_data(id); },
                                         [&] { manager.properties(id); },
                                         [&] { manager.remove_body(id); },
                                         [&] { manager.set_level(id, LevelChoice::full); },
                                         [&] { manager.set_importance(id, 1.0); },
                                         [&] {
                                           manager.set_state(id, at({0, 0, 0}));
                                         },
                                         [&] {
                                           manager.add_force(id, {1, 0, 0});
                                         },
                                         [&] {
                                           manager.add_impulse(id, {1, 0, 0}, {0, 0, 0});
                                         },
                                         [&] { manager.sleep(id); },
                                         [&] { manager.wake(id); },
                                         [&] { manager.set_user_data(id, 1); }};
    for (const auto& call : all) scene.refuses(call, "the id", "that of a body");
    RigidState state;
    scene.refuses([&] { manager.read_states({&id, 1}, {&state, 1}); }, "the id", "that of a body");
  }
}

TEST(BadInput, StatesAndDefinitions) {
  Scene scene;
  Manager& manager = scene.manager;
  RigidState flat = at({0, 0, 0}), crooked = at({0, 0, 0});
  flat.orientation.coeffs().setZero();
  crooked.orientation.coeffs() *= 1.0 + 2e-3;
  for (const auto& [state, found] : {std::pair{at({kNan, 0, 0}), "(nan, 0, 0)"},
                                     {at({0, 2e8, 0}), "(0, 2e+08, 0)"},
                                     {at({0, 0, 0}, {kInfinity, 0, 0}), "(inf, 0, 0)"},
                                     {at({0, 0, 0}, {0, 0, 0}, {0, kNan, 0}), "(0, nan, 0)"},
                                     {flat, "a quaternion of length 0"},
                                     {crooked, "a quaternion of length 1.002"}}) {
    scene.refuses([&, given = state] { add(manager, scene.shape, given); }, found, "");
    scene.refuses([&, given = state] { manager.set_state(scene.full, given); }, found, "");
    scene.refuses([&, given = state] { manager.set_state(scene.support, given); }, found, "");
  }
  const RigidState sound = at({9, 9, 9});
  scene.refuses([&] { add(manager, nullptr, sound); }, "none", "one");
  scene.refuses([&] { manager.add_body({.shape = scene.shape, .state = sound, .mass = 0.0}); }, "0",
                "a positive");
  for (const double mass : {1e-30, 1e-8, 1e300})
    scene.refuses([&, mass] { manager.add_body({.shape = scene.shape, .state = sound, .mass = mass}); }, "",
                  "1e-06 … 1e+12 kg");
  Shape thin = *scene.shape;
  thin.inertia_per_mass = Vec3(1e-300, 1.0, 1.0).asDiagonal();
  scene.refuses([&] { manager.add_body({.shape = std::make_shared<const Shape>(thin), .state = sound}); },
                "a moment of 1e-300 m²", "");
  scene.refuses([&] { manager.add_body({.shape = scene.shape, .state = sound, .material = 7}); }, "7",
                "0 … 0");
  scene.refuses([&] { manager.add_body({.shape = scene.shape, .state = sound, .importance = kNan}); }, "nan",
                "a positive");
  scene.refuses(
      [&] {
        manager.add_body({.shape = scene.shape, .state = sound, .properties = {.linear_damping = -1.0}});
      },
      "-1", "a finite number");
}

TEST(BadInput, NearlyUnitQuaternionIsNormalizedAndGreatSpeedIsBounded) {
  Scene scene;
  RigidState state = at({5, 0, 5}, {1e200, 1e200, 0}, {0, 0, -1e200});
  state.orientation.coeffs() *= 1.0 + 1e-5;
  for (const BodyId body : {scene.full, scene.support}) {
    scene.manager.set_state(body, state);
    const RigidState held = scene.manager.state(body);
    EXPECT_NEAR(held.orientation.norm(), 1.0, 1e-15);
    EXPECT_NEAR(held.velocity.x(), 1e6 * std::sqrt(0.5), 1e-3);
    EXPECT_NEAR(held.angular_velocity.z(), -1e6, 1e-3);
  }
}

TEST(BadInput, ForcesAndImpulses) {
  Scene scene;
  Manager& manager = scene.manager;
  scene.refuses([&] { manager.add_force(scene.full, {kNan, 0, 0}); }, "(nan, 0, 0)", "finite");
  scene.refuses(
      [&] {
        manager.add_force_at(scene.full, {1, 0, 0}, {kInfinity, 0, 0});
      },
      "(inf, 0, 0)", "finite");
  scene.refuses(
      [&] {
        manager.add_impulse(scene.support, {0, kInfinity, 0}, {0, 0, 0});
      },
      "(0, inf, 0)", "finite");
  manager.add_force(scene.full, {1e308, 0, 0});
  scene.refuses([&] { manager.add_force(scene.full, {1e308, 0, 0}); }, "a sum", "a finite one");
}

TEST(BadInput, SettingsAndGround) {
  Scene scene;
  Manager& manager = scene.manager;
  scene.refuses([&] { manager.set_gravity({0, 0, kNan}); }, "(0, 0, nan)", "finite");
  scene.refuses([&] { manager.set_threads(0); }, "0", "1 or more");
  scene.refuses([&] { manager.set_full_substeps(0); }, "0", "1 or more");
  PolicySettings policy;
  policy.hysteresis = kNan;
  scene.refuses([&] { manager.set_policy(policy); }, "nan", "0 or more");
  for (int PolicySettings::*const most : {&PolicySettings::most_full, &PolicySettings::most_support}) {
    PolicySettings none;
    none.*most = -1;
    scene.refuses([&] { manager.set_policy(none); }, "-1", "0 or more");
  }
  const Vec3 nowhere(0, kNan, 0);
  scene.refuses([&] { manager.set_viewpoints({&nowhere, 1}); }, "(0, nan, 0)", "finite");
  for (const double far : {1e300, -1e300}) {
    const Vec3 beyond(far, 0, 0);
    scene.refuses([&] { manager.set_viewpoints({&beyond, 1}); }, "", "a place within 1e+12 m");
    scene.refuses([&] { manager.set_viewpoints({Viewpoint{.position = beyond}}); }, "",
                  "a place within 1e+12 m");
  }
  scene.refuses([&] { manager.add_plane({0, 0, 2}, 0.0); }, "(0, 0, 2)", "a vector of unit length");
  scene.refuses([&] { manager.add_plane({0, 0, 1}, kInfinity); }, "inf", "a finite");
  scene.refuses([&] { manager.add_static_box({1, 0, 1}, {0, 0, 0}, Quat::Identity()); }, "0", "a positive");
  scene.refuses([&] { manager.add_static_box({1, 1, 1}, {0, 0, 0}, Quat::Identity(), 3); }, "3", "0 … 0");
  scene.refuses(
      [&] {
        manager.add_static_box({9000, 9000, 1e-4}, {0, 0, 0}, Quat::Identity());
      },
      "0.0001 m", "2e-06 of the longest");
  scene.refuses(
      [&] {
        manager.add_static_box({1e7, 1e7, 100}, {0, 0, 0}, Quat::Identity());
      },
      "1e+07 m", "0.0001 … 1e+06 m");
  scene.refuses(
      [&] {
        manager.add_static_mesh({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1e300}}, {{0, 1, 2}, {0, 2, 1}}});
      },
      "(0, 0, 1e+300)", "coordinates within 1e+06 m");
  scene.refuses(
      [&] {
        manager.add_static_mesh({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 1, 3}}});
      },
      "vertex 3", "0 … 2");
  scene.refuses([&] { manager.add_static_mesh({}); }, "0 faces", "two or more");
  EXPECT_THROW(Manager({.gravity = {kNan, 0, 0}}), InputError);
  EXPECT_THROW(Manager({.full_substeps = 0}), InputError);
  EXPECT_THROW(Manager(nullptr, nullptr), InputError);
}

// An impulse that is refused is in no recording either: it would end the replay.
TEST(BadInput, RefusedImpulseIsNotRecorded) {
  Scene scene;
  int chunks = 0;
  scene.manager.set_record([&](std::span<const std::byte>) { ++chunks; });
  const int before = chunks;
  EXPECT_THROW(scene.manager.add_impulse(scene.support, {1e308, 1e308, 1e308}, {1e8, 0, 0}), InputError);
  EXPECT_EQ(chunks, before);
}

TEST(BadInput, Materials) {
  MaterialTable table;
  for (const Material& bad :
       {Material{.restitution = 1.1}, Material{.restitution = -0.1}, Material{.restitution = kNan},
        Material{.friction = -1.0}, Material{.friction = kInfinity}, Material{.density = 0.0},
        Material{.density = kNan}}) {
    EXPECT_THROW(table.add(bad), InputError);
    EXPECT_THROW(table.replace(0, bad), InputError);
  }
  EXPECT_THROW(table.replace(1, {}), InputError);
  EXPECT_THROW(table.set_law(0, 0, {.restitution = 2.0}), InputError);
  EXPECT_THROW(table.set_law(0, 5, {}), InputError);
  EXPECT_EQ(table.size(), 1);
  EXPECT_EQ(table[0].restitution, Material{}.restitution);
  EXPECT_EQ(table.law(0, 0).restitution, Material{}.restitution);
}

// A source that fails once a body is to be demoted: nothing has moved, and the next step does what this one
// could not.
TEST(BadInput, StepThatThrowsForASignatureHasMovedNothing) {
  bool fails = true;
  ManagerSettings settings =
      unmeasured({.policy = DistancePolicy{.full_within = 4.0}, .min_dwell_frames = 0});
  settings.signatures = [&](const Shape&, const ContactLaw&) -> std::shared_ptr<const Signature> {
    if (fails) throw InputError("no signature today");
    return nullptr;
  };
  Manager manager = on_floor(settings);
  view_from(manager, {0, 0, 1});
  const BodyId body = add(manager, box_shape({0.2, 0.3, 0.4}), at({0, 0, 2}), LevelChoice::full);
  run(manager, 0.1);
  manager.set_level(body, LevelChoice::support);
  const std::uint64_t before = manager.state_hash();
  EXPECT_THROW(manager.step(kFrame), InputError);
  EXPECT_EQ(manager.state_hash(), before);
  EXPECT_EQ(manager.report().step, 6);
  EXPECT_EQ(manager.rung(body), Rung::full);
  fails = false;
  manager.step(kFrame);
  EXPECT_EQ(manager.rung(body), Rung::support);
  EXPECT_LT(manager.state(body).position.z(), 2.0);
}

// In a caller's world: what he changes before he steps again is seen, and nothing is ground twice, which a
// body between a box and another would feel.
TEST(BadInput, AfterAStepThatThrewTheCallersSpaceIsLookedAtAnew) {
  std::uint64_t hashes[2];
  for (const bool throws : {false, true}) {
    CallersScene his;
    dWorldSetGravity(his.world, 0, 0, -kGravity);
    dCreatePlane(his.space, 0, 0, 1, 0);
    his.box({2, 2, 0.2}, {0, 0, 0.1});
    bool fails = throws;
    ManagerSettings settings = unmeasured();
    settings.signatures = [&](const Shape&, const ContactLaw&) -> std::shared_ptr<const Signature> {
      if (fails) throw InputError("no signature today");
      return nullptr;
    };
    Manager manager(his.world, his.space, settings);
    for (int i = 0; i < 6; ++i)
      add(manager, box_shape({0.2, 0.2, 0.2}),
          at({0.05 * i, 0.4 * (i / 3), 0.31 + 0.25 * (i % 3)}, {1, 0, 0}), LevelChoice::support);
    if (throws) {
      EXPECT_THROW(manager.step(kFrame), InputError);
    }
    fails = false;
    his.box({0.2, 2, 0.8}, {0.6, 0, 0.4});
    run(manager, 0.8);
    hashes[throws] = manager.state_hash();
  }
  EXPECT_EQ(hashes[false], hashes[true]);
}

// Of a source that has none, or one of another shape.
TEST(BadInput, BodyForcedToTablesWithoutASignatureThatServes) {
  for (const bool of_another : {false, true}) {
    ManagerSettings settings = unmeasured();
    if (of_another)
      settings.signatures = [](const Shape&, const ContactLaw& law) {
        return coarse_signature(*box_shape({0.1, 0.1, 0.5}), law);
      };
    Manager manager = on_floor(settings);
    const BodyId body = add(manager, box_shape({0.2, 0.3, 0.4}), at({0, 0, 2}), LevelChoice::tables);
    EXPECT_THROW(manager.step(kFrame), InputError);
    EXPECT_EQ(manager.report().step, 0);
    manager.set_level(body, LevelChoice::full);
    manager.step(kFrame);
    EXPECT_EQ(manager.rung(body), Rung::full);
  }
}

TEST(BadInput, CallersGravityThatIsNoNumberStopsTheStepBeforeItBegins) {
  dInitODE2(0);
  const std::unique_ptr<dxWorld, decltype(&dWorldDestroy)> world(dWorldCreate(), &dWorldDestroy);
  const std::unique_ptr<dxSpace, decltype(&dSpaceDestroy)> space(dHashSpaceCreate(nullptr), &dSpaceDestroy);
  dWorldSetGravity(world.get(), 0, 0, -9.81);
  Manager manager(world.get(), space.get(), unmeasured());
  const BodyId body = add(manager, sphere_shape(0.1), at({0, 0, 1}));
  manager.step(kFrame);
  dWorldSetGravity(world.get(), 0, 0, kNan);
  const std::uint64_t before = manager.state_hash();
  EXPECT_THROW(manager.step(kFrame), InputError);
  EXPECT_EQ(manager.state_hash(), before);
  dWorldSetGravity(world.get(), 0, 0, -1.0);
  manager.step(kFrame);
  EXPECT_NEAR(manager.state(body).velocity.z(), -(9.81 + 1.0) * kFrame, 1e-12);
  EXPECT_EQ(manager.gravity().z(), -1.0);
}

TEST(AssertionDeathTest, HandlerIsCalledBeforeTheAbort) {
  const auto break_it = [] {
    set_assertion_handler([](std::string_view message) {
      std::fprintf(stderr, "the handler read: %s", std::string(message).c_str());
    });
    check_that(false, "one is two:", "1, 2");
  };
  EXPECT_DEATH(break_it(), "the handler read: .*one is two: 1, 2");
}

}  // namespace
}  // namespace lodestone::bad_input_test
