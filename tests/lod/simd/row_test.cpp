#include "lod/simd/row.h"

#include <gtest/gtest.h>

#include "reference/random.h"

namespace lodestone::lane {
namespace {

Row draw(RandomStream& random) {
  const auto number = [&] { return float(random.uniform(-10, 10)); };
  const float x = number(), y = number(), z = number(), w = number();
  return {x, y, z, w};
}

TEST(Row, LanesAreItsFourNumbersInOrder) {
  RandomStream random(1, 0, 0);
  for (int i = 0; i < 100; ++i) {
    const Row a = draw(random), b = draw(random), back = row_of(lanes_of(a));
    EXPECT_TRUE(back.x == a.x && back.y == a.y && back.z == a.z && back.w == a.w);
    const Row sum = row_of(lanes_of(a) + lanes_of(b)), less = row_of(lanes_of(a) - lanes_of(b)),
              product = row_of(lanes_of(a) * lanes_of(b)), twice = row_of(2.5f * lanes_of(a));
    EXPECT_TRUE(sum.x == a.x + b.x && sum.y == a.y + b.y && sum.z == a.z + b.z && sum.w == a.w + b.w);
    EXPECT_TRUE(less.x == a.x - b.x && less.y == a.y - b.y && less.z == a.z - b.z && less.w == a.w - b.w);
    EXPECT_TRUE(product.x == a.x * b.x && product.y == a.y * b.y && product.z == a.z * b.z &&
                product.w == a.w * b.w);
    EXPECT_TRUE(twice.x == 2.5f * a.x && twice.y == 2.5f * a.y && twice.z == 2.5f * a.z &&
                twice.w == 2.5f * a.w);
  }
}

TEST(Row, OnlyTheLastIsKept) {
  const Row row = row_of(only_w(lanes_of(Row{2, 3, 4, 5})));
  EXPECT_TRUE(row.x == 1 && row.y == 1 && row.z == 1 && row.w == 5);
}

TEST(Row, WhatIsAddedStays) {
  Row row{1, 2, 3, 4};
  add_to(row, lanes_of(Row{10, 20, 30, 40}));
  add_to(row, lanes_of(Row{0, 0, 0, -4}));
  EXPECT_TRUE(row.x == 11 && row.y == 22 && row.z == 33 && row.w == 40);
  EXPECT_EQ(sizeof(Row), 16U);
  EXPECT_EQ(alignof(Row), 16U);
}

}  // namespace
}  // namespace lodestone::lane
