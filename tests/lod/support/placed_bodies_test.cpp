// Bodies of `support` that are put where others are part until hardly anything is left of their overlap, and
// sleep only then.
#include <gtest/gtest.h>

#include "tests/lod/rungs/rung_fixture.h"

namespace lodestone::placed_bodies_test {

constexpr double kSide = 0.3, kFrame = 1.0 / 60;  // m, s
constexpr double kLeft = 0.02 * kSide;            // m

struct Column {
  Column() { ground.add_plane({}); }
  void add(double height) { add(Vec3(0.0, 0.0, height)); }
  void add(const Vec3& place) {
    static const auto cube =
        std::make_shared<const Shape>(make_shape("cube", make_box({kSide, kSide, kSide})));
    RigidState state;
    state.position = place;
    level.add(std::uint32_t(level.size()), cube, 27.0, 0, state, false, nullptr);
  }
  /// s until all sleep; at most that.
  double run(double most) {
    StepReport report;
    int frames = 0;
    for (; level.asleep_count() < level.size() && frames * kFrame < most; ++frames)
      level.step(kFrame, {}, report);
    return frames * kFrame;
  }
  double deepest_overlap() const {
    double deepest = 0.0;
    for (int one = 0; one < level.size(); ++one)
      for (int other = 0; other < one; ++other)
        deepest =
            std::max(deepest, kSide - (level.position(one) - level.position(other)).cwiseAbs().maxCoeff());
    return deepest;
  }

  Ground ground;
  MaterialTable materials;
  testing::OneRung level{StatisticalModel::support, {}, ground, materials};
};

// Of five 9 % of a side were left, and some never slept.
TEST(PlacedBodies, AColumnThatOverlapsRisesUntilItStands) {
  for (const auto& [cubes, overlap] : {std::pair{3, 0.02}, {5, 0.02}, {5, 0.06}, {5, 0.12}, {8, 0.02}}) {
    Column column;
    for (int i = 0; i < cubes; ++i) column.add(0.5 * kSide + (kSide - overlap) * i);
    EXPECT_LT(column.run(20.0), 6.0) << cubes << ", " << overlap;
    EXPECT_LT(column.deepest_overlap(), kLeft) << cubes << ", " << overlap;
  }
}

TEST(PlacedBodies, OneThatIsPutIntoAColumnFindsRoom) {
  Column column;
  column.add(1.5);
  for (int i = 0; i < 4; ++i) column.add(kSide * (i + 0.5));
  column.run(5.0);
  RigidState state;
  state.position = {0.05, 0.0, 0.6};
  column.level.set_state(0, state);
  EXPECT_LT(column.run(20.0), 3.0);
  EXPECT_LT(column.deepest_overlap(), kLeft);
}

// Three rows of .9 m in a bin of .88.
TEST(PlacedBodies, WhereThereIsNoRoomTheySleepAllTheSame) {
  constexpr double kBin = 0.88, kApart = 0.29;  // m
  Column bin;
  for (const Vec3& way : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY())})
    for (const double sign : {-1.0, 1.0}) bin.ground.add_plane({.normal = sign * way, .offset = -0.5 * kBin});
  for (int i = 0; i < 36; ++i)
    bin.add({kApart * (i % 3 - 1), kApart * (i / 3 % 3 - 1), 0.5 * kSide + kApart * (i / 9)});
  EXPECT_LT(bin.run(20.0), 7.0);
}

}  // namespace lodestone::placed_bodies_test
