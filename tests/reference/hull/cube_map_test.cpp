#include "reference/hull/cube_map.h"

#include <gtest/gtest.h>

#include <set>

#include "reference/random.h"

namespace lodestone {
namespace {

TEST(CubeMap, ADirectionLiesWithinReachOfTheMiddleOfItsCell) {
  for (const int side : {1, 2, 7, 16}) {
    const CubeMap cells(side);
    RandomStream random(63, std::uint32_t(side), 0);
    std::set<int> seen;
    for (int i = 0; i < 20'000; ++i) {
      const Vec3 unit = random.direction();
      const int cell = cells.cell_of(random.uniform(1e-6, 1e6) * unit);
      ASSERT_TRUE(cell >= 0 && cell < cells.size());
      seen.insert(cell);
      EXPECT_LE((unit - cells.middle_of(cell).normalized()).norm(), cells.find_reach(cell) + 1e-12);
    }
    EXPECT_EQ(int(seen.size()), cells.size());
    for (int cell = 0; cell < cells.size(); ++cell) EXPECT_EQ(cells.cell_of(cells.middle_of(cell)), cell);
  }
}

}  // namespace
}  // namespace lodestone
