#include "signature/response.h"

#include <gtest/gtest.h>

#include <numbers>

namespace lodestone {
namespace {

constexpr double kHalfTurn = std::numbers::pi;

TEST(CollisionConfiguration, AlphaAndUnitAreThoseOfSpeedAndSpin) {
  const CollisionConfiguration c{.speed = 3.0, .spin = 4.0};
  EXPECT_DOUBLE_EQ(c.alpha(), std::atan(4.0 / 3.0));
  EXPECT_DOUBLE_EQ(c.speed_unit(), 5.0);
  EXPECT_EQ((CollisionConfiguration{.speed = 2.0, .spin = 0.0}.alpha()), 0.0);
  EXPECT_DOUBLE_EQ((CollisionConfiguration{.speed = 0.0, .spin = 2.0}.alpha()), kHalfTurn / 2);
}

TEST(ResponseTable, CellsAreInTheMiddleOfTheirParts) {
  const ResponseTable table{2, 3, 4, 5, {}};
  EXPECT_EQ(table.size(), 120);
  const CollisionConfiguration first = table.center(0), last = table.center(119);
  EXPECT_DOUBLE_EQ(first.theta, kHalfTurn / 8);
  EXPECT_DOUBLE_EQ(first.phi, kHalfTurn / 6);
  EXPECT_DOUBLE_EQ(first.alpha(), kHalfTurn / 16);
  EXPECT_EQ(first.psi, 0.0);
  EXPECT_DOUBLE_EQ(last.theta, 3 * kHalfTurn / 8);
  EXPECT_DOUBLE_EQ(last.phi, 5 * kHalfTurn / 6);
  EXPECT_DOUBLE_EQ(last.alpha(), 7 * kHalfTurn / 16);
  EXPECT_DOUBLE_EQ(last.psi, 2 * kHalfTurn * 4 / 5);
  EXPECT_DOUBLE_EQ(last.speed_unit(), 1.0);
  EXPECT_DOUBLE_EQ(table.center(5).alpha(), 3 * kHalfTurn / 16);  // ψ runs fastest, then α
}

TEST(ResponseTable, OfAConfigurationThatCellIsTakenInWhosePartItLies) {
  const ResponseTable table{2, 3, 4, 5, {}};
  for (std::int64_t cell = 0; cell < table.size(); ++cell) {
    CollisionConfiguration c = table.center(cell);
    ASSERT_EQ(table.find_cell(c), cell);
    // Up to its edges, at any speed.
    c.theta += 0.49 * kHalfTurn / 4, c.phi -= 0.49 * kHalfTurn / 3, c.psi += 0.49 * 2 * kHalfTurn / 5;
    const double alpha = c.alpha() + 0.49 * kHalfTurn / 8;
    c.speed = 7.0 * std::cos(alpha), c.spin = 7.0 * std::sin(alpha);
    EXPECT_EQ(table.find_cell(c), cell);
  }
}

TEST(ResponseTable, ThePlaneAndTheAxisAreInTheOutermostCells) {
  const ResponseTable table{2, 3, 4, 1, {}};
  EXPECT_EQ(table.find_cell({.theta = 0, .phi = 0, .speed = 1, .spin = 0}), 0);
  EXPECT_EQ(table.find_cell({.theta = kHalfTurn / 2, .phi = kHalfTurn, .speed = 0, .spin = 1}),
            table.size() - 1);
}

TEST(ResponseTable, AzimuthsGoRound) {
  const ResponseTable table{1, 1, 1, 4, {}};
  for (const auto& [psi, cell] : {std::pair{0.0, 0},
                                  {0.24 * kHalfTurn, 0},
                                  {0.26 * kHalfTurn, 1},
                                  {1.74 * kHalfTurn, 3},
                                  {1.76 * kHalfTurn, 0},
                                  {2 * kHalfTurn, 0},
                                  {-0.26 * kHalfTurn, 3},
                                  {-2 * kHalfTurn, 0},
                                  {4.5 * kHalfTurn, 1}})
    EXPECT_EQ(table.find_cell({.theta = 1, .phi = 1, .psi = psi, .speed = 1, .spin = 1}), cell) << psi;
}

TEST(SpeedTable, TheNearestSampleOfEachSpeedCounts) {
  const SpeedTable table{2, 2, {0.1f, 1.0f, 10.0f}, {0.0f, 2.0f}, {}};
  EXPECT_EQ(table.size(), 24);
  for (std::int64_t cell = 0; cell < table.size(); ++cell)
    EXPECT_EQ(table.find_cell(table.center(cell)), cell);
  const auto at = [&](double speed, double spin) {
    const CollisionConfiguration c =
        table.center(table.find_cell({.theta = 0, .phi = 0, .speed = speed, .spin = spin}));
    return std::pair(float(c.speed), float(c.spin));
  };
  EXPECT_EQ(at(0.0, 0.9), std::pair(0.1f, 0.0f));
  EXPECT_EQ(at(0.56, 1.1), std::pair(1.0f, 2.0f));
  EXPECT_EQ(at(1e6, 1e6), std::pair(10.0f, 2.0f));
}

}  // namespace
}  // namespace lodestone
