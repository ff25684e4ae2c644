// What substeps are for: many bodies that fall on each other.
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace lodestone
