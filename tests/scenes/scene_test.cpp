#include "scenes/scene.h"

#include <gtest/gtest.h>

namespace lodestone {
namespace {

TEST(SceneViewpoint, StandsWithoutAPath) {
  SceneViewpoint viewpoint;
  viewpoint.position_m = {1, 2, 3};
  EXPECT_EQ(viewpoint.position_at(0), Vec3(1, 2, 3));
  EXPECT_EQ(viewpoint.position_at(1e6), Vec3(1, 2, 3));
}

TEST(SceneViewpoint, MovesLinearlyBetweenCorners) {
  SceneViewpoint viewpoint;
  viewpoint.path = {{1, {0, 0, 0}}, {2, {4, 0, 0}}, {4, {4, 2, 0}}};
  EXPECT_EQ(viewpoint.position_at(0), Vec3(0, 0, 0));
  EXPECT_EQ(viewpoint.position_at(1), Vec3(0, 0, 0));
  EXPECT_EQ(viewpoint.position_at(1.25), Vec3(1, 0, 0));
  EXPECT_EQ(viewpoint.position_at(2), Vec3(4, 0, 0));
  EXPECT_EQ(viewpoint.position_at(3), Vec3(4, 1, 0));
  EXPECT_EQ(viewpoint.position_at(4), Vec3(4, 2, 0));
  EXPECT_EQ(viewpoint.position_at(99), Vec3(4, 2, 0));
}

}  // namespace
}  // namespace lodestone
