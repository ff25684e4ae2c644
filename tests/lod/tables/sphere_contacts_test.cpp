#include "lod/tables/sphere_contacts.h"

#include <gtest/gtest.h>

#include "tests/lod/tables/sphere_fixture.h"

namespace lodestone {
namespace {

using testing::at;
using testing::SphereScene;

constexpr float kBounceVelocity = 0.05f;
constexpr double kRadius = 0.1;

// Balls without gravity, answered by a few rounds of contacts.
struct Balls : SphereScene {
  explicit Balls(double friction = 0.5, double restitution = 0.4)
      : SphereScene(1.0 / 60.0, Vec3::Zero()), materials(ContactLaw{restitution, friction}) {}

  std::int64_t ball(const RigidState& state, double mass = 1.0) { return add(shape, mass, state); }
  void find(Simd simd = Simd::portable) {
    start(simd);
    grid.fill({spheres_of(spheres.x), spheres_of(spheres.y), spheres_of(spheres.z), step.reach});
    contacts.find(spheres, dense, grid, kBounceVelocity, constants, simd, jobs, nullptr);
    clear_added(0, spheres.awake, step);
  }
  /// The second of two balls asleep: their touch is found alone.
  void put_second_to_sleep() {
    spheres.put_to_sleep(1);
    step.resize(1);
  }
  void find_touch_of_sleeper() {
    find();
    const std::pair<std::uint32_t, std::uint32_t> touches[] = {{0, 1}};
    contacts.add(spheres, dense, touches, kBounceVelocity, constants, Simd::portable);
  }
  SweepOutcome answer(int rounds = 2, Simd simd = Simd::portable, bool eased = false) {
    SweepOutcome outcome;
    contacts.begin(spheres, dense, materials, constants, step, jobs);
    for (int round = 1; round <= rounds; ++round) {
      outcome = contacts.sweep(spheres, dense, materials, kBounceVelocity, constants, round == rounds, eased,
                               simd, step, jobs);
      if (round < rounds) take_impulses(simd, 0, spheres.awake, step);
    }
    return outcome;
  }
  std::span<const double> spheres_of(const std::vector<double>& all) const {
    return std::span(all).first(std::size_t(spheres.awake));
  }
  Vec3 momentum() const {
    Vec3 sum = Vec3::Zero();
    for (std::int64_t i = 0; i < spheres.awake; ++i)
      sum += step.velocity(i) / spheres.inverse_mass[std::size_t(i)];
    return sum;
  }

  std::shared_ptr<const Shape> shape = testing::sphere_shape(kRadius);
  MaterialTable materials;
  CellGrid grid;
  JobRunner jobs = make_job_runner(1);
  SphereContacts contacts;
};

TEST(SphereContacts, AnImpactKeepsMomentumAndItsPartOfTheSpeed) {
  for (const double mass : {1.0, 10.0})
    for (const double restitution : {0.0, 0.4, 1.0}) {
      Balls scene(0.5, restitution);
      scene.ball(at({-kRadius, 0, 0}, {2, 0, 0}), mass);
      scene.ball(at({kRadius, 0, 0}, {-1, 0, 0}));
      scene.constants.one_kind = false;  // of two masses
      scene.find();
      ASSERT_EQ(scene.contacts.count(), 1);
      scene.answer();
      EXPECT_LT((scene.momentum() - Vec3(2 * mass - 1, 0, 0)).norm(), 1e-5 * mass);
      EXPECT_NEAR(scene.step.velocity(1).x() - scene.step.velocity(0).x(), 3 * restitution, 1e-5);
    }
}

TEST(SphereContacts, ASlowApproachEndsWithoutABounce) {
  Balls scene(0.5, 1.0);
  scene.ball(at({-kRadius, 0, 0}, {0.04, 0, 0}));
  scene.ball(at({kRadius, 0, 0}));
  scene.find(), scene.answer();
  EXPECT_NEAR(scene.step.velocity(0).x(), 0.02, 1e-7);
  EXPECT_NEAR(scene.step.velocity(1).x(), 0.02, 1e-7);
}

// A gap that is there may close: they come to touch at the end of the step, and no sooner.
TEST(SphereContacts, AcrossAGapTheyMayComeAsNearAsItIs) {
  const double gap = 5e-4;
  Balls scene;
  scene.ball(at({-kRadius - gap, 0, 0}, {0.04, 0, 0}));
  scene.ball(at({kRadius, 0, 0}));
  scene.find();
  ASSERT_EQ(scene.contacts.count(), 1);
  scene.answer();
  const double closing = scene.step.velocity(0).x() - scene.step.velocity(1).x();
  EXPECT_NEAR(closing, std::min(0.04, gap * 60), 1e-5);
}

// Balls that strike off centre: friction turns them, momentum and angular momentum stay, and what slips is
// braked by μ times the normal impulse at most; a solid ball's slip ends after 2/7 of it where that is less.
TEST(SphereContacts, FrictionTurnsBallsAndKeepsTheirAngularMomentum) {
  for (const double friction : {0.0, 0.1, 10.0}) {
    Balls scene(friction, 0.0);
    scene.ball(at({-kRadius, 0, 0}, {1, 1, 0}));
    scene.ball(at({kRadius, 0, 0}, {-1, -1, 0}));
    const auto angular_momentum = [&] {
      Vec3 sum = Vec3::Zero();
      for (int i = 0; i < 2; ++i)
        sum += scene.spheres.position(i).cross(scene.step.velocity(i)) + scene.spheres.spin(i) +
               scene.step.added_spin(i);
      return sum;
    };
    scene.find();
    const Vec3 before = angular_momentum();
    scene.answer();
    EXPECT_LT(scene.momentum().norm(), 1e-6);
    EXPECT_LT((angular_momentum() - before).norm(), 1e-6);
    const double braked = 1.0 - scene.step.velocity(0).y();
    EXPECT_NEAR(braked, std::min(friction * 1.0, 2.0 / 7.0), 1e-5) << friction;
    EXPECT_NEAR(scene.step.velocity(0).x(), 0.0, 1e-6);
  }
}

TEST(SphereContacts, ARoundSaysWhatItChangedAtMost) {
  for (const int rounds : {1, 2}) {
    Balls scene(0.5, 0.4);
    scene.ball(at({-kRadius, 0, 0}, {2, 0, 0}));
    scene.ball(at({kRadius, 0, 0}, {-1, 0, 0}));
    scene.ball(at({kRadius, 1, 0}, {0.2, 0, 0}));
    scene.ball(at({2.99 * kRadius, 1, 0}));
    scene.find();
    ASSERT_EQ(scene.contacts.count(), 2);
    const SweepOutcome outcome = scene.answer(rounds);
    EXPECT_NEAR(outcome.changed, rounds == 1 ? 1.4 * 3.0 : 0.0, 1e-5);
    EXPECT_NEAR(outcome.deepest, 0.01 - 0.002, 1e-5);
  }
}

// Half of what is deeper than .08 R, in a round; of what comes slowly from another rung nothing.
TEST(SphereContacts, DeepOverlapsAreOpenedFurther) {
  for (const bool eased : {false, true}) {
    Balls scene;
    scene.ball(at({-0.08, 0, 0}));
    scene.ball(at({0.08, 0, 0}), 3.0);
    scene.constants.one_kind = false;
    scene.spheres.eased[1] = eased ? 100 : 0;
    scene.find(), scene.answer(2, Simd::portable, eased);
    const auto parted = [&] { return scene.step.push_out(1).x() - scene.step.push_out(0).x(); };
    const double before = parted(), left = 0.04 - before - 0.08 * kRadius;
    scene.contacts.move_apart(scene.spheres, scene.dense, scene.step, scene.jobs);
    EXPECT_NEAR(parted() - before, eased ? 0.0 : 0.5 * left, 1e-6);
    EXPECT_NEAR(-scene.step.push_out(0).x() / scene.step.push_out(1).x(), 3.0, 1e-4);
    for (int round = 0; round < 20; ++round)
      scene.contacts.move_apart(scene.spheres, scene.dense, scene.step, scene.jobs);
    EXPECT_NEAR(parted(), eased ? before : 0.04 - 0.08 * kRadius, 1e-6);
  }
}

TEST(SphereContacts, AnOverlapOpensByHalfOfWhatIsBeyondTheSlop) {
  for (const bool eased : {false, true}) {
    Balls scene;
    scene.ball(at({-0.09, 0, 0}));
    scene.ball(at({0.09, 0, 0}), 3.0);
    scene.constants.one_kind = false;
    scene.spheres.eased[1] = eased ? 100 : 0;
    scene.find(), scene.answer(2, Simd::portable, eased);
    const double overlap = 0.02, way = 0.5 * (overlap - 0.002 * kRadius);
    // Of eased ones no faster than .1 √(g R), here with g of 1 m/s² at least.
    const double parts = eased ? std::min(way, 0.1 * std::sqrt(kRadius) / 60) : way;
    EXPECT_NEAR(scene.step.push_out(1).x() - scene.step.push_out(0).x(), parts, 1e-6) << eased;
    EXPECT_NEAR(-scene.step.push_out(0).x() / scene.step.push_out(1).x(), 3.0, 1e-4);  // by their masses
    EXPECT_EQ(scene.step.velocity(0), Vec3::Zero());
  }
}

TEST(SphereContacts, ASleeperIsAWall) {
  Balls scene(0.5, 0.5);
  scene.ball(at({-kRadius, 0, 0}, {2, 0, 0}));
  scene.ball(at({kRadius, 0, 0}));
  scene.put_second_to_sleep();
  scene.find();
  EXPECT_EQ(scene.contacts.count(), 0);
  scene.find_touch_of_sleeper();
  ASSERT_EQ(scene.contacts.count(), 1);
  scene.answer();
  EXPECT_NEAR(scene.step.velocity(0).x(), -1.0, 1e-6);
  EXPECT_EQ(scene.spheres.position(1), Vec3(kRadius, 0, 0));
}

// A plane gives as a wall does, with its own law.
TEST(SphereContacts, PlanesHaveLawsOfTheirOwn) {
  Balls scene(0.5, 0.0);
  scene.ball(at({0, 0, kRadius}, {1, 0, -2}));
  scene.find();
  const PlaneTouch touch{.place = 0, .plane = 3, .normal = {0, 0, 1}, .closing = -2.0f, .law = {0.25, 0.0}};
  scene.contacts.add_ground(scene.spheres, {&touch, 1}, kBounceVelocity, scene.constants);
  scene.answer();
  EXPECT_LT((scene.step.velocity(0) - Vec3(1, 0, 0.5)).norm(), 1e-6);
}

double known_impulse(const Balls& scene) {
  double impulse = -1.0;
  scene.contacts.each([&](const SphereContact& contact) { impulse = contact.impulse; });
  return impulse;
}

TEST(SphereContacts, WhatBoreIsRememberedAndABlowIsNot) {
  for (const double speed : {0.04, 0.06}) {
    Balls scene(0.5, 0.0);
    scene.ball(at({-kRadius, 0, 0}, {speed, 0, 0}));
    scene.ball(at({kRadius, 0, 0}, {-speed / 2, 0, 0}));
    scene.find(), scene.answer();
    const double closing = 1.5 * speed, gave = known_impulse(scene);
    EXPECT_NEAR(gave, closing / 2, 1e-6);  // to end it, with masses of 1 kg
    const bool blow = closing > kBounceVelocity;
    scene.find();  // from the same states
    EXPECT_EQ(known_impulse(scene), 0.0) << "an impact takes up nothing";
    for (double& v : scene.spheres.vx) v = 0.0;
    scene.find();
    EXPECT_NEAR(known_impulse(scene), blow ? 0.0 : gave, 1e-7) << speed;
  }
}

TEST(SphereContacts, WhatWasRememberedIsGivenAtOnce) {
  Balls scene(0.5, 0.0);
  scene.ball(at({-kRadius, 0, 0}, {0.02, 0, 0}));
  scene.ball(at({kRadius, 0, 0}, {-0.02, 0, 0}));
  scene.find(), scene.answer();
  scene.find();
  scene.contacts.begin(scene.spheres, scene.dense, scene.materials, scene.constants, scene.step, scene.jobs);
  EXPECT_NEAR(scene.step.velocity(0).x(), 0.0, 1e-7);
  EXPECT_TRUE(scene.step.touches(0) && scene.step.touches(1));
}

TEST(SphereContacts, OrAsMuchOfItAsTheStepSays) {
  Balls scene(0.5, 0.0);
  scene.ball(at({-kRadius, 0, 0}, {0.02, 0, 0}));
  scene.ball(at({kRadius, 0, 0}, {-0.02, 0, 0}));
  scene.find(), scene.answer();
  scene.constants.remembered = 0.75f;
  scene.find();
  EXPECT_NEAR(known_impulse(scene), 0.75 * 0.02, 1e-7);
}

// In a heap in which a single one is awake there are no other contacts.
TEST(SphereContacts, WhatSleepersBoreIsRememberedToo) {
  Balls scene(0.5, 0.0);
  scene.ball(at({-kRadius, 0, 0}, {0.02, 0, 0}));
  scene.ball(at({kRadius, 0, 0}));
  scene.put_second_to_sleep();
  scene.find_touch_of_sleeper(), scene.answer();
  scene.find_touch_of_sleeper();
  EXPECT_NEAR(known_impulse(scene), 0.02, 1e-7);
}

TEST(SphereContacts, AFilterLetsPairsThrough) {
  Balls scene;
  scene.ball(at({-kRadius, 0, 0}, {1, 0, 0}));
  scene.ball(at({kRadius, 0, 0}));
  scene.contacts.set_pair_filter([](std::uint32_t a, std::uint32_t b) { return std::min(a, b) != 0; });
  scene.find();
  EXPECT_EQ(scene.contacts.count(), 0);
}

TEST(SphereContacts, AreTheSameToTheBitOnEveryProcessor) {
  std::vector<double> expected;
  for (const Simd simd : testing::kEverySimd) {
    if (!testing::has(simd)) continue;
    Balls scene;
    RandomStream random(11, 0, 0);
    for (int i = 0; i < 400; ++i)  // more than sixteen runs of sixteen at a time
      scene.ball(at({random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1)},
                    random.uniform(0, 1) * random.direction(), 5 * random.direction()));
    for (int i = 0; i < 3; ++i) {
      scene.find(simd), scene.answer(3, simd);
      EXPECT_GT(scene.contacts.count(), 400);
      Vec3 before = Vec3::Zero();
      for (int k = 0; k < 400; ++k) before += scene.spheres.velocity(k);
      EXPECT_LT((scene.momentum() - before).norm(), 1e-3);  // of some 200 kg m/s, in single precision
      scene.end(simd);
    }
    const std::vector<double> found = scene.numbers();
    if (expected.empty()) expected = found;
    EXPECT_TRUE(found == expected) << int(simd);
  }
}

}  // namespace
}  // namespace lodestone
