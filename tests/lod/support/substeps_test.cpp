// What substeps are for: many bodies that fall on each other.
#include <gtest/gtest.h>

#include "reference/random.h"
#include "tests/lod/rungs/rung_fixture.h"
#include "tools/compare/pile_overlap.h"
#include "tools/compare/pile_start.h"

namespace lodestone {
namespace {

class Bin : public ::testing::Test {
 protected:
  void fill(int bodies) {
    for (const HalfSpace& plane : make_bin(kSide)) ground_.add_plane(plane);
    level_.emplace(StatisticalModel::support, StatisticalSettings{}, ground_, materials_);
    for (const RigidState& start : make_pile_start(*shape_, {.bodies = bodies, .side = kSide}, 1))
      level_->add(std::uint32_t(level_->size()), shape_, 1000.0 * shape_->volume, 0, start, false, nullptr);
  }
  std::vector<RigidState> states() const {
    std::vector<RigidState> all;
    for (int i = 0; i < level_->size(); ++i) all.push_back(level_->state(i));
    return all;
  }

  static constexpr double kSide = 1.2;
  std::shared_ptr<const Shape> shape_ =
      std::make_shared<const Shape>(make_shape("box", make_box({0.2, 0.3, 0.4})));
  Ground ground_;
  MaterialTable materials_;
  std::optional<testing::OneRung> level_;
};

// Forty boxes in ten layers, which arrive at up to 11 m/s.
TEST_F(Bin, APileOfBoxesSleepsWithoutSinkingIntoItself) {
  fill(40);
  const PileOverlap overlap(*shape_, {ground_.planes().begin(), ground_.planes().end()});
  StepReport report;
  double deepest = 0.0;
  for (int i = 0; i < 360; ++i) {
    level_->step(1.0 / 60.0, {}, report);
    if (i % 12 == 0) deepest = std::max(deepest, overlap.deepest(states()));
  }
  EXPECT_EQ(level_->asleep_count(), level_->size());
  EXPECT_LT(deepest, 0.1 * shape_->size);
  EXPECT_EQ(overlap.count_escaped(states()), 0);
  EXPECT_EQ(overlap.count_hovering(states(), std::vector<char>(40, 1), 0.05 * shape_->size), 0);
}

// A body that is near no other takes the whole step at once, whatever the others do.
TEST_F(Bin, ALoneBodyDoesNotDependOnACrowd) {
  fill(8);
  const RigidState far{.position = Vec3(0.0, 0.0, 60.0), .angular_velocity = Vec3(3.0, 1.0, 2.0)};
  const int lone = level_->add(100, shape_, 24.0, 0, far, false, nullptr);
  testing::OneRung alone(StatisticalModel::support, StatisticalSettings{}, ground_, materials_);
  alone.add(100, shape_, 24.0, 0, far, false, nullptr);
  StepReport report;
  for (int i = 0; i < 120; ++i) level_->step(1.0 / 60.0, {}, report), alone.step(1.0 / 60.0, {}, report);
  EXPECT_EQ(level_->state(lone).position, alone.state(0).position);
  EXPECT_EQ(level_->state(lone).orientation.coeffs(), alone.state(0).orientation.coeffs());
}

// Of two that lie on each other, with or without two others far away that run into each other at 30 m/s:
// these need a dozen substeps, and nobody else.
TEST(Substeps, OfAnIslandAreNotDisturbedByWhatGoesOnElsewhere) {
  const auto shape = std::make_shared<const Shape>(make_shape("box", make_box({0.2, 0.3, 0.4})));
  Ground ground;
  ground.add_plane({});
  MaterialTable materials;
  const auto run = [&](bool with_others) {
    testing::OneRung level(StatisticalModel::support, {.sleeping = false}, ground, materials);
    const auto add = [&](const RigidState& state) {
      return level.add(std::uint32_t(level.size()), shape, 24.0, 0, state, false, nullptr);
    };
    add({.position = Vec3(0.0, 0.0, 0.25)});
    const int upper = add({.position = Vec3(0.05, 0.02, 0.9), .angular_velocity = Vec3(2.0, 1.0, 0.4)});
    if (with_others) {
      add({.position = Vec3(50.0, 0.0, 9.0), .velocity = Vec3(30.0, 0.0, 3.0)});
      add({.position = Vec3(60.0, 0.1, 9.0), .velocity = Vec3(-30.0, 0.0, 3.0)});
    }
    StepReport report;
    for (int i = 0; i < 30; ++i) level.step(1.0 / 60.0, {}, report);
    EXPECT_LT(level.state(level.size() - 1).velocity.norm(), 28.0) << "the others have met";
    return level.state(upper);
  };
  const RigidState alone = run(false), beside = run(true);
  EXPECT_GT(alone.velocity.norm() + alone.angular_velocity.norm(), 1e-3) << "it moves still";
  EXPECT_EQ(alone.position, beside.position);
  EXPECT_EQ(alone.orientation.coeffs(), beside.orientation.coeffs());
  EXPECT_EQ(alone.velocity, beside.velocity);
}

// A level floor of triangles is the plane that it lies in: boxes fall, strike and turn over its seams as over
// that.
TEST(TriangleFloor, IsThePlaneThatItLiesIn) {
  const auto shape = std::make_shared<const Shape>(make_shape("box", make_box({0.2, 0.3, 0.4})));
  Mesh floor;
  for (const double y : {-9.0, 0.3, 9.0})
    for (const double x : {-9.0, -0.2, 0.5, 9.0}) floor.vertices.emplace_back(x, y, 0.0);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 3; ++x) {
      const int a = 4 * y + x;
      floor.faces.push_back({a, a + 1, a + 5}), floor.faces.push_back({a, a + 5, a + 4});
    }
  Ground plane, triangles;
  plane.add_plane({}), triangles.add_mesh(floor, 0);
  MaterialTable materials;
  for (std::uint32_t trial = 0; trial < 20; ++trial) {
    testing::OneRung on_plane(StatisticalModel::support, {}, plane, materials),
        on_triangles(StatisticalModel::support, {}, triangles, materials);
    RandomStream random(77, trial, 0);
    RigidState start;
    start.position = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0.4, 1.0)};
    start.orientation = random.orientation();
    start.velocity = random.direction();
    start.angular_velocity = 4.0 * random.direction();
    for (testing::OneRung* level : {&on_plane, &on_triangles})
      level->add(0, shape, 24.0, 0, start, false, nullptr);
    StepReport report;
    for (int i = 0; i < 60; ++i)
      on_plane.step(1.0 / 60.0, {}, report), on_triangles.step(1.0 / 60.0, {}, report);
    EXPECT_LT((on_plane.state(0).position - on_triangles.state(0).position).norm(), 1e-6) << trial;
  }
}

}  // namespace
}  // namespace lodestone
