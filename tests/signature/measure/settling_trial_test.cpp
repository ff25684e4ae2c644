#include "signature/measure/settling_trial.h"

#include <gtest/gtest.h>

#include <numbers>

#include "reference/drop_trial.h"
#include "reference/free_rotation.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

const Vec3 kSides(0.2, 0.3, 0.4);

// A box lies on one of its six faces: half a side high, a body axis upright.
TEST(SettlingTrial, ABoxComesToRestOnAFace) {
  const auto box = testing::box_shape(kSides);
  SettlingTrial trial(box, {0.4, 0.5});
  for (std::uint32_t i = 0; i < 6; ++i) {
    const SettlingRecord record = trial.run(1, i, true);
    ASSERT_TRUE(record.rests) << i;
    int axis = 0;
    EXPECT_GT(record.normal.cwiseAbs().maxCoeff(&axis), 0.999);
    EXPECT_NEAR(record.height, 0.5 * kSides[axis], 0.002 * box->radius) << i;
  }
}

// From the first contact of little energy on, as they are observed, to rest.
TEST(SettlingTrial, ItsStatesGoFromLittleEnergyToRest) {
  const auto box = testing::box_shape(kSides);
  SettlingTrial trial(box, {0.4, 0.5});
  const SettlingRecord record = trial.run(1, 2, true);
  ASSERT_GT(record.states.size(), 2U);
  const RigidState &first = record.states.front(), &last = record.states.back();
  EXPECT_LT(kinetic_energy(*box, first), kClipEnergy * kSettlingGravity * box->radius);
  EXPECT_LE(gap_over_ground(*box, first), kEntryGap * box->radius);
  EXPECT_LT(kinetic_energy(*box, last), 0.01 * kClipEnergy * kSettlingGravity * box->radius);
  EXPECT_NEAR(last.position.z(), record.height, 1e-3);
  for (std::size_t i = 1; i < record.states.size(); ++i)  // kObservationStep apart: none leaps
    EXPECT_LT((record.states[i].position - record.states[i - 1].position).norm(), 1.5 * kObservationStep);
}

TEST(SettlingTrial, IsOfSeedAndTrialAlone) {
  const auto box = testing::box_shape(kSides);
  SettlingTrial one(box, {0.4, 0.5}), other(box, {0.4, 0.5});
  for (std::uint32_t i = 0; i < 3; ++i) one.run(1, i, true);
  const SettlingRecord after_others = one.run(1, 9, true), alone = other.run(1, 9, true);
  ASSERT_EQ(after_others.states.size(), alone.states.size());
  for (std::size_t i = 0; i < alone.states.size(); ++i)
    EXPECT_TRUE(testing::same_bits(after_others.states[i], alone.states[i])) << i;
  for (const SettlingRecord& another : {other.run(2, 9, true), other.run(1, 10, true)}) {
    ASSERT_FALSE(another.states.empty());
    EXPECT_FALSE(testing::same_bits(another.states[0], alone.states[0]));
  }
}

// Where the pose alone is asked for, the drop ends sooner, in the same pose, and keeps no states.
TEST(SettlingTrial, ThePoseIsKnownBeforeRest) {
  const auto box = testing::box_shape(kSides);
  SettlingTrial trial(box, {0.4, 0.5});
  for (std::uint32_t i = 0; i < 4; ++i) {
    const SettlingRecord whole = trial.run(1, i, true), pose = trial.run(1, i, false);
    EXPECT_TRUE(pose.states.empty());
    ASSERT_EQ(pose.rests, whole.rests);
    EXPECT_GT(pose.normal.dot(whole.normal), 0.99) << i;
  }
}

TEST(SettlingTrial, ABallNeverRests) {
  SettlingTrial trial(testing::sphere_shape(0.1), {0.4, 0.5});
  const SettlingRecord record = trial.run(1, 1, true);
  EXPECT_FALSE(record.rests);
  EXPECT_TRUE(record.states.empty());
}

TEST(GapOverGround, IsThatOfTheLowestPoint) {
  const auto box = testing::box_shape({0.2, 0.2, 0.2});
  EXPECT_NEAR(gap_over_ground(*box, testing::at({5, 6, 0.3})), 0.2, 1e-12);
  const Quat on_edge = rotation_from_vector(Vec3(std::numbers::pi / 4, 0, 0));
  EXPECT_NEAR(gap_over_ground(*box, testing::at({0, 0, 0.1}, {0, 0, 0}, {0, 0, 0}, on_edge)),
              0.1 - 0.1 * std::sqrt(2.0), 1e-12);
}

}  // namespace
}  // namespace lodestone
