#include "reference/ode/islands.h"

#include <gtest/gtest.h>

namespace lodestone {
namespace {

OdeContact contact(std::uint32_t first, std::uint32_t second) { return {{first}, {second}, Vec3::Zero(), Vec3::UnitZ(), 0.001}; }

TEST(Islands, CountsTheContactsThatHangTogether) {
  EXPECT_EQ(largest_island({}), 0);
  const std::vector<OdeContact> contacts{contact(1, 2), contact(2, 3), contact(3, 0), contact(5, 6), contact(7, 0), contact(7, 0)};
  EXPECT_EQ(largest_island(contacts), 3);
}

// The ground holds nothing together: two piles on one floor are two islands.
TEST(Islands, TheGroundIsNoLink) {
  const std::vector<OdeContact> contacts{contact(1, 0), contact(2, 0)};
  EXPECT_EQ(largest_island(contacts), 1);
}

}  // namespace
}  // namespace lodestone
