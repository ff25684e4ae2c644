#include "tools/compare/depth_grid.h"

#include <gtest/gtest.h>

namespace lodestone {
namespace {

// Legs of .3 and .2 m, bars .08 m wide, .1 m thick, about the middle of the bounding box: the long leg lies
// along the lower side.
TEST(DepthGrid, KnowsLegsFromTheNotchBetweenThem) {
  const DepthGrid grid(make_l(0.3, 0.2, 0.08, 0.1));
  EXPECT_NEAR(grid.depth({0.05, -0.06, 0.0}), 0.04, 0.004);  // middle of the long leg
  EXPECT_NEAR(grid.depth({0.05, -0.09, 0.0}), 0.01, 0.004);  // near its outer side
  EXPECT_NEAR(grid.depth({0.05, 0.01, 0.0}), -0.03, 0.004);  // in the notch
  EXPECT_LT(grid.depth({1.0, 0.0, 0.0}), -1e6);
}

TEST(DepthGrid, IsSignedAcrossTheSurface) {
  const DepthGrid grid(make_sphere(0.1));
  for (const double r : {0.03, 0.08, 0.099, 0.101})
    EXPECT_NEAR(grid.depth(r * Vec3(1, 2, -2) / 3.0), 0.1 - r, 0.003) << r;
}

}  // namespace
}  // namespace lodestone
