#include "signature/measure/certify.h"

#include <gtest/gtest.h>

namespace lodestone {
namespace {

TEST(Certify, KolmogorovSmirnovDistance) {
  EXPECT_DOUBLE_EQ(kolmogorov_smirnov({1, 2, 3}, {3, 1, 2}), 0.0);
  EXPECT_DOUBLE_EQ(kolmogorov_smirnov({1, 2, 3}, {4, 5}), 1.0);
  EXPECT_DOUBLE_EQ(kolmogorov_smirnov({1, 2, 3, 4}, {3, 4, 5, 6}), 0.5);
  EXPECT_DOUBLE_EQ(kolmogorov_smirnov({1, 1, 1, 2}, {1, 2, 2, 2}), 0.5);  // ties
}

}  // namespace
}  // namespace lodestone
