#include "lod/manager/views.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lod/manager/remoteness.h"

namespace lodestone {
namespace {

constexpr double kPi = std::numbers::pi;

Views looking(const Vec3& direction, double aspect = 2.0) {
  const Viewpoint viewpoint{.position = {1, 2, 3},
                            .direction = direction,
                            .vertical_fov_rad = kPi / 2,
                            .height_px = 1000,
                            .aspect = aspect};
  return Views(std::span(&viewpoint, 1));
}

TEST(Views, AFrustumIsAsHighAndWideAsItsPicture) {
  const Views views = looking({5, 0, 0});  // half its height is its distance, half its width twice that
  const auto sees = [&](double ahead, double left, double up) {
    return views.sees(Vec3(1 + ahead, 2 + left, 3 + up), 0.0);
  };
  EXPECT_TRUE(sees(10, 0, 0) && sees(10, 19.9, 9.9) && sees(10, -19.9, -9.9));
  EXPECT_FALSE(sees(10, 20.1, 0) || sees(10, -20.1, 0) || sees(10, 0, 10.1) || sees(10, 0, -10.1) ||
               sees(-1, 0, 0));
}

TEST(Views, ABallThatReachesIntoTheFrustumIsSeen) {
  const Views views = looking({1, 0, 0}, 1.0);
  const Vec3 outside(1 + 10, 2 + 11, 3);  // 1/√2 from the side
  EXPECT_FALSE(views.sees(outside, 0.70));
  EXPECT_TRUE(views.sees(outside, 0.71));
}

TEST(Views, LookingStraightDownHasAPictureToo) {
  const Views views = looking({0, 0, -1});
  EXPECT_TRUE(views.sees({1, 2, 0}, 0.0));
  EXPECT_FALSE(views.sees({1, 2, 6}, 0.0));
}

TEST(Views, WithoutADirectionItSeesAllAround) {
  const Views views(std::vector<Vec3>{Vec3::Zero()});
  EXPECT_FALSE(views.any_frustum());
  EXPECT_TRUE(views.sees({-100, 3, 5}, 0.0));
}

TEST(Views, OnlyTurningCounts) {
  const Views ahead = looking({1, 0, 0});
  EXPECT_FALSE(looking({7, 0, 0}).turned_since(ahead));
  EXPECT_TRUE(looking({1, 0.01, 0}).turned_since(ahead));
  EXPECT_TRUE(looking({1, 0, 0}, 1.5).turned_since(ahead));
  const Viewpoint elsewhere{.position = {9, 9, 9},
                            .direction = Vec3(1, 0, 0),
                            .vertical_fov_rad = kPi / 2,
                            .height_px = 1000,
                            .aspect = 2.0};
  EXPECT_FALSE(Views(std::span(&elsewhere, 1)).turned_since(ahead));
}

TEST(Remoteness, ASizeIsTheReciprocalOfPixels) {
  const Views views = looking({1, 0, 0});
  LevelCandidate ball{.position = Vec3(1 + 10, 2, 3), .radius = 0.5};
  EXPECT_NEAR(1.0 / remoteness(ball, views, Measure::size), 50.0,
              1e-9);  // 1 m of the 20 m that 1,000 pixels show there
  ball.importance = 2.0;
  EXPECT_NEAR(1.0 / remoteness(ball, views, Measure::size), 100.0, 1e-9);
  ball.view_factor = 4.0;
  EXPECT_NEAR(1.0 / remoteness(ball, views, Measure::size), 25.0, 1e-9);
}

TEST(Remoteness, OutOfViewForGoodIsInfinitelyFar) {
  LevelCandidate ball{
      .position = Vec3(10, 0, 0), .radius = 0.5, .view_factor = std::numeric_limits<double>::infinity()};
  EXPECT_EQ(remoteness(ball, std::vector<Vec3>{Vec3::Zero()}), std::numeric_limits<double>::infinity());
}

TEST(Remoteness, LooksAlongTheWayAhead) {
  LevelCandidate ball{.position = Vec3(-10, 3, 0), .radius = 1.0, .ahead = Vec3(20, 0, 0)};
  EXPECT_NEAR(remoteness(ball, std::vector<Vec3>{Vec3::Zero()}), 2.0, 1e-12);
  ball.ahead = Vec3(4, 0, 0);
  EXPECT_NEAR(remoteness(ball, std::vector<Vec3>{Vec3::Zero()}), std::hypot(6, 3) - 1.0, 1e-12);
  ball.no_farther_than = 0.5;
  EXPECT_EQ(remoteness(ball, std::vector<Vec3>{Vec3::Zero()}), 0.5);
}

// What is left out of the candidates for so long must not have been wanted elsewhere meanwhile.
TEST(Remoteness, NoBodyChangesBeforeTheViewpointHasTravelledSoFar) {
  const Limits limits(ProjectedSizePolicy{.full_above_px = 200, .support_above_px = 40});
  for (int i = 1; i < 200; ++i)
    for (const Rung rung : {Rung::tables, Rung::support}) {
      const LevelCandidate ball{.position = Vec3(0.2 * i, 0, 0), .radius = 0.3, .rung = rung};
      const auto seen_from = [](double x) { return Views(std::vector<Vec3>{Vec3(x, 0, 0)}); };
      if (!stays_put(ball, seen_from(0), limits)) continue;
      const double travel = travel_until_change(ball, seen_from(0), limits, 0.1);
      ASSERT_GT(travel, 0.0) << i;
      if (travel > 1e6) continue;
      const double way = rung == Rung::tables || remoteness(ball, seen_from(0.999 * travel), Measure::size) <
                                                     remoteness(ball, seen_from(0), Measure::size)
                             ? 0.999 * travel
                             : -0.999 * travel;
      const double now = remoteness(ball, seen_from(way), Measure::size);
      EXPECT_GT(now, limits.full_within) << i;
      if (rung == Rung::tables)
        EXPECT_GT(now, limits.support_within) << i;
      else
        EXPECT_LE(now, limits.support_within * 1.1) << i;
    }
}

}  // namespace
}  // namespace lodestone
