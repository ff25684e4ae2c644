#include "reference/ode/islands.h"

#include <gtest/gtest.h>

namespace lodestone {
namespace {

OdeContact contact(std::uint32_t first, std::uint32_t second) {
  return {{first}, {second}, Vec3::Zero(), Vec3::UnitZ(), 0.001};
}

TEST(Islands, CountsTheContactsThatHangTogether) {
  EXPECT_EQ(largest_island({}), 0);
  const std::vector<OdeContact> contacts{contact(1, 2), contact(2, 3), contact(3, 0),
                                         contact(5, 6), contact(7, 0), contact(7, 0)};
  EXPECT_EQ(largest_island(contacts), 3);
}

// An id's value is no small number: the highest bits are its slot's generation.
TEST(Islands, GenerationsOfIdsCostNothing) {
  const std::uint32_t old = 0xffe00000u;
  const std::vector<OdeContact> contacts{contact(old + 1, old + 2), contact(old + 2, 1), contact(old + 3, 0)};
  for (int i = 0; i < 10'000; ++i)
    ASSERT_EQ(largest_island(contacts),
              2);  // each a gigabyte's work if arrays were as long as the ids are large
}

// The ground holds nothing together: two piles on one floor are two islands.
TEST(Islands, TheGroundIsNoLink) {
  const std::vector<OdeContact> contacts{contact(1, 0), contact(2, 0)};
  EXPECT_EQ(largest_island(contacts), 1);
}

}  // namespace
}  // namespace lodestone
