// The elements of the paper's sphere, each by itself: its radius (3.3.1) and its rest pose (3.4).
#include "lod/tables/tables_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lod/statistical/flight.h"
#include "reference/random.h"
#include "signature/collision_heights.h"
#include "tests/lod/rungs/rung_fixture.h"

namespace lodestone {
namespace {

BodyKind box_kind() { return make_body_kind(testing::box(), testing::box_signature()); }

// Moves at 1 m/s and turns about x, ‖ω‖R/‖v‖ = tan α.
StatisticalBody body_that_moves(double alpha, std::uint32_t events) {
  StatisticalBody body;
  body.velocity = Vec3::UnitX();
  body.spin =
      spin_of(body.orientation, std::tan(alpha) / testing::box()->radius * Vec3::UnitX(), *testing::box());
  body.owner = 3, body.events = events;
  return body;
}

TEST(TablesModel, TheRadiusIsTheMeanHeightOfHowTheBodyMoves) {
  const BodyKind kind = box_kind();
  for (const double alpha : {0.1, 0.7, 1.3}) {
    const double mean = find_collision_height(kind.signature->collision_heights, alpha).mean;
    EXPECT_NEAR(find_sphere_radius(body_that_moves(alpha, 0), kind, {}, 1), mean * kind.shape->radius, 1e-9);
  }
}

TEST(TablesModel, DrawnHeightsHaveTheMeanAndTheDeviationMeasured) {
  const BodyKind kind = box_kind();
  constexpr int kDraws = 4'000;
  constexpr double kAlpha = 0.7;
  const HeightStatistics measured = find_collision_height(kind.signature->collision_heights, kAlpha);
  ASSERT_GT(measured.deviation, 0.01);
  double sum = 0.0, squares = 0.0;
  for (std::uint32_t events = 0; events < kDraws; ++events) {
    const StatisticalBody body = body_that_moves(kAlpha, events);
    const double height = find_sphere_radius(body, kind, {.draw_height = true}, 1) / kind.shape->radius;
    EXPECT_GE(height, 0.05);
    EXPECT_LE(height, 1.0);
    sum += height, squares += height * height;
  }
  const double mean = sum / kDraws, deviation = std::sqrt(squares / kDraws - mean * mean);
  EXPECT_NEAR(mean, measured.mean,
              4.0 * measured.deviation / std::sqrt(double(kDraws)) + 0.02 * measured.deviation);
  EXPECT_NEAR(deviation, measured.deviation, 0.1 * measured.deviation);
}

// One draw a contact: until the next one the sphere keeps it, whichever step asks.
TEST(TablesModel, AHeightIsDrawnAnewWithEachContactAlone) {
  const BodyKind kind = box_kind();
  const auto drawn = [&](std::uint32_t events, std::uint64_t seed) {
    return find_sphere_radius(body_that_moves(0.7, events), kind, {.draw_height = true}, seed);
  };
  EXPECT_EQ(drawn(5, 1), drawn(5, 1));
  EXPECT_NE(drawn(5, 1), drawn(6, 1));
  EXPECT_NE(drawn(5, 1), drawn(5, 2));
}

// A body whose spin is begun in flight: at interval 1 its radius follows within the step, at 8 with the
// eighth.
TEST(TablesModel, TheRadiusIsUpdatedAtItsInterval) {
  const Ground ground;
  const MaterialTable materials;
  for (const int interval : {2, 8}) {
    StatisticalSettings settings;
    settings.gravity.setZero();
    settings.tables.radius_update_interval = interval;
    testing::OneRung level(StatisticalModel::tables, settings, ground, materials);
    RigidState state;
    state.velocity = Vec3::UnitX(), state.angular_velocity = {8.0, 3.0, 1.0};
    const int slot = level.add(0, testing::box(), 24.0, 0, state, false, testing::box_signature());
    int changes = 0;
    double radius = level.sphere_radius(slot);
    for (int step = 0; step < 64; ++step) {
      StepReport report;
      level.step(1.0 / 60, {}, report);
      changes += level.sphere_radius(slot) != radius;
      radius = level.sphere_radius(slot);
    }
    EXPECT_GT(changes, 0) << interval;
    EXPECT_LE(changes, 64 / interval) << interval;
  }
}

// From flight with a spin, at which the sphere is high, into a rest pose whose height is another: by no more
// than a fifth of the way in a step.
TEST(TablesModel, TheRadiusGrowsGraduallyIntoThatOfTheRestPose) {
  Ground ground;
  ground.add_plane({.normal = Vec3::UnitZ()});
  const MaterialTable materials;
  StatisticalSettings settings;
  settings.tables.published = true;
  testing::OneRung level(StatisticalModel::tables, settings, ground, materials);
  RigidState state;
  state.position.z() = 0.6;
  state.orientation = RandomStream(2, 0, 0).orientation();
  state.angular_velocity = {5.0, 4.0, 3.0};
  const int slot = level.add(0, testing::box(), 24.0, 0, state, false, testing::box_signature());
  double radius = level.sphere_radius(slot), leap = 0.0, first = radius;
  for (int step = 0; step < 300; ++step) {
    StepReport report;
    level.step(1.0 / 60, {}, report);
    leap = std::max(leap, std::abs(level.sphere_radius(slot) - radius));
    radius = level.sphere_radius(slot);
  }
  EXPECT_TRUE(level.asleep(slot));
  EXPECT_GT(std::abs(radius - first), 0.02);
  EXPECT_LT(leap, 0.2 * testing::box()->radius);
}

// Tilted by 40° out of the tall pose: still nearest to it, but beyond the edge over which it tips.
TEST(TablesModel, TheNearestPoseNeedsTheSmallestRotationAndTheOtherIsTippedInto) {
  BodyKind kind = box_kind();
  const RestingFaces faces(testing::box()->hull);
  kind.faces = std::shared_ptr<const RestingFaces>(std::shared_ptr<void>(), &faces);
  const MaterialTable materials;
  const HalfSpace floor{.normal = Vec3::UnitZ()};
  const StepWorld world{.gravity = {0, 0, -9.81}, .planes = {&floor, 1}, .materials = &materials};
  const double tilt = 40.0 * std::numbers::pi / 180.0;
  const Quat orientation(Eigen::AngleAxisd(tilt, Vec3::UnitY()));
  const auto axis_of = [&](bool nearest) {
    const RestingRecord record =
        find_resting(orientation, kind, floor, world, 0.0, {.nearest_rest_pose = nearest});
    EXPECT_GE(record.pose, 0);
    int axis = 0;
    kind.signature->rest_poses[std::size_t(record.pose)].normal.cwiseAbs().maxCoeff(&axis);
    return axis;
  };
  EXPECT_EQ(axis_of(true), 2);   // .4 m upright, 40° away
  EXPECT_EQ(axis_of(false), 0);  // .2 m upright: the edge between them is at atan(.2/.4) = 27°
}

// What was set on a face on which no trial ends stays there, as long as it has not the energy to tip off it.
TEST(TablesModel, ABookOnEndStandsUnlessItTips) {
  const auto book = std::make_shared<const Shape>(make_shape("book", make_box({0.04, 0.2, 0.3})));
  auto lies = std::make_shared<Signature>();
  lies->rest_poses = {{.normal = Vec3::UnitX(), .height = 0.02 / book->radius, .frequency = 1.0}};
  BodyKind kind = make_body_kind(book, lies);
  kind.faces = std::make_shared<const RestingFaces>(book->hull);
  const MaterialTable materials;
  const HalfSpace floor{.normal = Vec3::UnitZ()};
  const StepWorld world{.gravity = {0, 0, -9.81}, .planes = {&floor, 1}, .materials = &materials};
  const auto pose = [&](double tilt, double energy, const TablesOptions& options = {}) {
    return find_resting(Quat(Eigen::AngleAxisd(tilt, Vec3::UnitY())), kind, floor, world, energy, options)
        .pose;
  };
  const double pass = 9.81 * (std::hypot(0.15, 0.02) - 0.15);  // J/kg
  EXPECT_EQ(pose(0.0, 0.0), -1);
  EXPECT_EQ(pose(0.0, 0.9 * pass), -1);
  EXPECT_EQ(pose(0.0, 1.1 * pass), 0);
  EXPECT_EQ(pose(0.1, 0.0), 0);
  EXPECT_EQ(pose(0.0, 0.0, {.published = true}), 0);
}

}  // namespace
}  // namespace lodestone
