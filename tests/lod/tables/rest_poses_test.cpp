// The paper's figure 7: with rest poses a body ends on a face and its sphere fits it, without it ends as it
// came down.
#include <gtest/gtest.h>

#include "reference/random.h"
#include "tests/lod/rungs/rung_fixture.h"

namespace lodestone {
namespace {

using testing::box, testing::box_signature;

// Of boxes that have come down for six seconds: how far the least tilted axis is from upright, and how far
// the sphere from the height of a face; means, of 1 and of the box's radius.
struct Ended {
  double tilt = 0, misfit = 0;
};

Ended end_of_falls(bool rest_poses) {
  constexpr int kBoxes = 20;
  Ground ground;
  ground.add_plane({.normal = Vec3::UnitZ()});
  const MaterialTable materials;
  StatisticalSettings settings;
  settings.tables.rest_poses = rest_poses;
  testing::OneRung level(StatisticalModel::tables, settings, ground, materials);
  for (int i = 0; i < kBoxes; ++i) {
    RandomStream random(5, std::uint64_t(i), 0);
    RigidState state;
    state.position = Vec3(2.0 * i, 0, 0.8);
    state.orientation = random.orientation();
    level.add(std::uint32_t(i), box(), 24.0, 0, state, false, box_signature());
  }
  for (int step = 0; step < 360; ++step) {
    StepReport report;
    level.step(1.0 / 60, {}, report);
  }
  Ended ended;
  for (int i = 0; i < kBoxes; ++i) {
    const Vec3 up = level.state(i).orientation.conjugate() * Vec3::UnitZ();
    double misfit = 1e9;
    for (const RestPose& pose : box_signature()->rest_poses)
      misfit = std::min(misfit, std::abs(level.sphere_radius(i) / box()->radius - pose.height));
    ended.tilt += (1.0 - up.cwiseAbs().maxCoeff()) / kBoxes;
    ended.misfit += misfit / kBoxes;
  }
  return ended;
}

TEST(RestPoses, BodiesLieOnFacesWithThemAndAskewWithout) {
  const Ended with = end_of_falls(true), without = end_of_falls(false);
  EXPECT_LT(with.tilt, 0.01);
  EXPECT_LT(with.misfit, 0.01);
  EXPECT_GT(without.tilt, 0.05);
  EXPECT_GT(without.misfit, 0.02);
}

// Hardly a trial ends on end: what was set so, among its like, stays so all the same.
TEST(RestPoses, ARowOfBooksStandsOnEnd) {
  const auto book = std::make_shared<const Shape>(make_shape("book", make_box({0.04, 0.2, 0.3})));
  SignatureSettings coarse;
  coarse.n_theta = 3, coarse.n_phi = 3, coarse.n_alpha = 4, coarse.trials_per_cell = 8;
  coarse.height_trials = 60, coarse.settling_trials = 20, coarse.clips = 4;
  const auto signature = std::make_shared<const Signature>(measure_signature(*book, coarse, 2));
  Ground ground;
  ground.add_plane({.normal = Vec3::UnitZ()});
  const MaterialTable materials;
  testing::OneRung level(StatisticalModel::tables, StatisticalSettings{}, ground, materials);
  constexpr int kBooks = 12;
  for (int i = 0; i < kBooks; ++i)
    level.add(std::uint32_t(i), book, 1.5, 0, {.position = Vec3(0.0402 * i, 0, 0.15)}, false, signature);
  for (int step = 0; step < 240; ++step) {
    StepReport report;
    level.step(1.0 / 60, {}, report);
  }
  for (int i = 0; i < kBooks; ++i) {
    EXPECT_NEAR((level.state(i).orientation * Vec3::UnitZ()).z(), 1.0, 0.01) << i;
    EXPECT_TRUE(level.asleep(i)) << i;
  }
}

// A ball of many faces comes to rest on none of them often enough: its signature has no pose, and it ended
// the process.
TEST(RestPoses, WhatIsFinelyRoundHasNoneAndLiesAsItCameDown) {
  const auto round = std::make_shared<const Shape>(make_shape("round", make_sphere(0.15, 3)));
  SignatureSettings coarse;
  coarse.n_theta = 3, coarse.n_phi = 3, coarse.n_alpha = 4, coarse.trials_per_cell = 8;
  coarse.height_trials = 60, coarse.settling_trials = 20, coarse.clips = 0;
  coarse.rest_pose_frequency_min = 1.0;
  const auto signature = std::make_shared<const Signature>(measure_signature(*round, coarse, 2));
  ASSERT_TRUE(signature->rest_poses.empty());
  Ground ground;
  ground.add_plane({.normal = Vec3::UnitZ()});
  for (const Vec3& inwards : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)})
    ground.add_plane({.normal = inwards, .offset = -0.5});
  const MaterialTable materials;
  for (const bool published : {false, true}) {
    StatisticalSettings settings;
    settings.tables.published = published;
    testing::OneRung level(StatisticalModel::tables, settings, ground, materials);
    constexpr int kBalls = 8;
    for (int i = 0; i < kBalls; ++i)
      level.add(std::uint32_t(i), round, 14.0, 0,
                {.position = Vec3(0.3 * (i % 2) - 0.1, 0.3 * (i / 2 % 2) - 0.2, 0.4 + 0.4 * (i / 4))}, false,
                signature);
    for (int step = 0; step < 240; ++step) {
      StepReport report;
      level.step(1.0 / 60, {}, report);
    }
    for (int i = 0; i < kBalls; ++i) EXPECT_GT(level.state(i).position.z(), 0.14) << published;
  }
}

}  // namespace
}  // namespace lodestone
