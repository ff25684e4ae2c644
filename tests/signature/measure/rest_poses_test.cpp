#include "signature/measure/rest_poses.h"

#include <gtest/gtest.h>

#include "signature/measure/measurement_shape.h"
#include "signature/measure/settling_trial.h"

namespace lodestone {
namespace {

std::vector<SettlingRecord> settle(const Shape& shape, std::uint32_t count, bool whole = false,
                                   double friction = 0.5) {
  SettlingTrial trial(make_measurement_shape(shape), {0.4, friction});
  std::vector<SettlingRecord> records;
  for (std::uint32_t i = 0; i < count; ++i) records.push_back(trial.run(9, i, whole));
  return records;
}

TEST(RestPoses, CubeRestsEvenlyOnItsSixFaces) {
  constexpr int kTrials = 1200;
  const Shape cube = make_shape("cube", make_box({0.3, 0.3, 0.3}));
  const std::vector<RestPose> poses =
      find_rest_poses(settle(cube, kTrials), *make_measurement_shape(cube), 0.004);
  ASSERT_EQ(poses.size(), 6u);
  double chi_squared = 0.0;
  for (const RestPose& pose : poses) {
    EXPECT_NEAR(pose.height, 1.0 / std::sqrt(3.0), 1e-3);
    EXPECT_NEAR(pose.normal.cwiseAbs().maxCoeff(), 1.0, 1e-6);
    EXPECT_NEAR(pose.basin, 1.0 / 6.0, 0.01);
    const double difference = (pose.frequency - 1.0 / 6.0) * kTrials;
    chi_squared += difference * difference / (kTrials / 6.0);
  }
  EXPECT_LT(chi_squared, 20.5);  // five degrees of freedom, p .001
}

TEST(RestPoses, LongBoxRarelyStandsOnItsEnd) {
  const Shape box = make_shape("long", make_box({0.1, 0.1, 0.4}));
  const std::vector<RestPose> poses = find_rest_poses(settle(box, 1000), *make_measurement_shape(box), 0.0);
  double on_end = 0.0, on_side = 0.0;
  for (const RestPose& pose : poses) (std::abs(pose.normal.z()) > 0.9 ? on_end : on_side) += pose.frequency;
  EXPECT_LT(on_end, 0.01);
  EXPECT_GT(on_side, 0.99);
}

// Ending a drop where its pose is certain does not change the pose.
TEST(RestPoses, ThePoseThatIsCertainIsThePoseAtRest) {
  for (const Shape& shape :
       {make_shape("box", make_box({0.2, 0.3, 0.4})), make_shape("l", make_l(0.3, 0.2, 0.08, 0.1)),
        make_shape("needle", make_needle(0.4, 0.01))}) {
    const std::vector<SettlingRecord> certain = settle(shape, 100), whole = settle(shape, 100, true);
    for (std::size_t i = 0; i < whole.size(); ++i) {
      ASSERT_TRUE(whole[i].rests && certain[i].rests);
      EXPECT_GT(certain[i].normal.dot(whole[i].normal), std::cos(kSamePose)) << shape.name << i;
      EXPECT_TRUE(certain[i].states.empty());
      EXPECT_GE(whole[i].states.size(), 2u);
    }
  }
}

// It slides for ever; each drop took half a minute of the simulated world.
TEST(RestPoses, ABoxWithoutFrictionHasThem) {
  const Shape box = make_shape("box", make_box({0.2, 0.3, 0.4}));
  for (const double friction : {0.0, 0.01}) {
    int rest = 0;
    for (const bool whole : {false, true})
      for (const SettlingRecord& record : settle(box, 40, whole, friction)) {
        rest += record.rests;
        if (!record.rests) continue;
        EXPECT_GT(record.normal.cwiseAbs().maxCoeff(), 0.99);
        // What slides on is no clip.
        if (record.states.empty()) continue;
        EXPECT_LT(record.states.back().velocity.norm(), 0.05);
      }
    EXPECT_GT(rest, 72) << friction;
  }
}

TEST(RestPoses, ABallHasNoneAndIsNotDropped) {
  const auto records = settle(make_sphere_shape(0.1), 1'000'000, true);
  ASSERT_EQ(records.size(), 1'000'000u);
  for (const SettlingRecord& record : records) ASSERT_FALSE(record.rests);
}

}  // namespace
}  // namespace lodestone
