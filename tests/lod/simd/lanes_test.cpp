#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored \
    "-Wpsabi"  // all is inlined: no such vector is handed from function to function
#endif
#include "lod/simd/lanes.h"

#include <gtest/gtest.h>

#include "reference/random.h"

namespace lodestone::lane {
namespace {

TEST(Lanes, RowsBecomeColumnsAndComeBack) {
  const D4 in[4] = {{1, 2, 3, 9}, {4, 5, 6, 9}, {7, 8, 10, 9}, {11, 12, 13, 9}};
  const V4 v = columns_of(in[0], in[1], in[2], in[3]);
  D4 out[4];
  rows_of(v, out);
  for (int lane = 0; lane < kLanes<D4>; ++lane) {
    EXPECT_EQ(v.x[lane], in[lane][0]);
    EXPECT_EQ(v.y[lane], in[lane][1]);
    EXPECT_EQ(v.z[lane], in[lane][2]);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(out[lane][i], in[lane][i]);
    EXPECT_EQ(out[lane][3], 0.0);
  }
}

TEST(Lanes, EightRowsOfTwoVectorsBecomeColumnsAndComeBack) {
  F8 in[8], out[8];
  for (int row = 0; row < 8; ++row)
    for (int i = 0; i < 8; ++i) in[row][i] = float(10 * row + i);
  V8 lower, upper;
  columns_of(in, lower, upper);
  rows_of(lower, upper, out);
  for (int lane = 0; lane < kLanes<F8>; ++lane) {
    const float at = float(10 * lane);
    EXPECT_EQ(lower.x[lane], at);
    EXPECT_EQ(lower.y[lane], at + 1);
    EXPECT_EQ(lower.z[lane], at + 2);
    EXPECT_EQ(upper.x[lane], at + 4);
    EXPECT_EQ(upper.y[lane], at + 5);
    EXPECT_EQ(upper.z[lane], at + 6);
    for (int i = 0; i < 8; ++i) EXPECT_EQ(out[lane][i], i % 4 == 3 ? 0.0F : in[lane][i]);
  }
}

TEST(Lanes, SayWhetherAnyIsSet) {
  for (int lane = 0; lane < kLanes<F8>; ++lane) {
    F8 one = {};
    EXPECT_FALSE(any(one > F8{}));
    one[lane] = 1e-30F;
    EXPECT_TRUE(any(one > F8{}));
  }
}

TEST(Lanes, CalculateAsVectorsDo) {
  RandomStream random(2, 0, 0);
  for (int i = 0; i < 100; ++i) {
    const Vec3 a = random.direction(), b = random.direction();
    const V4 wide_a{all<D4>(a.x()), all<D4>(a.y()), all<D4>(a.z())},
        wide_b{all<D4>(b.x()), all<D4>(b.y()), all<D4>(b.z())};
    EXPECT_NEAR(dot(wide_a, wide_b)[2], a.dot(b), 1e-15);
    const V4 c = cross(wide_a, wide_b);
    EXPECT_LT((Vec3(c.x[1], c.y[1], c.z[1]) - a.cross(b)).norm(), 1e-15);
    EXPECT_EQ(absolute(all<D4>(-a.x()))[0], std::abs(a.x()));
    EXPECT_EQ(square_root(all<D4>(2.0))[3], std::sqrt(2.0));
  }
}

}  // namespace
}  // namespace lodestone::lane
