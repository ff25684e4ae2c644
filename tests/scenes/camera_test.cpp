#include "scenes/camera.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lodestone {
namespace {

// From 10 m in front of the origin the picture is 10 tan 30° high to each side, and 16/9 times as wide.
TEST(Camera, SeesWithinItsPicture) {
  const Camera camera({0, -10, 0}, Vec3::Zero());
  const double half_height = 10.0 / std::sqrt(3.0), half_width = half_height * 16 / 9;
  EXPECT_TRUE(camera.sees(Vec3::Zero()));
  EXPECT_TRUE(camera.sees({0.99 * half_width, 0, 0.99 * half_height}));
  EXPECT_TRUE(camera.sees({-0.99 * half_width, 0, -0.99 * half_height}));
  EXPECT_FALSE(camera.sees({1.01 * half_width, 0, 0}));
  EXPECT_FALSE(camera.sees({0, 0, -1.01 * half_height}));
  EXPECT_FALSE(camera.sees({0, -11, 0})) << "behind it";
}

TEST(Camera, LooksDownToo) {
  const Camera camera({3, 2, 9}, {3, 2, 0});
  EXPECT_TRUE(camera.sees({3, 2, 1}));
  EXPECT_FALSE(camera.sees({3, 2, 10}));
  EXPECT_TRUE(camera.sees({3.5, 1.5, 0}));
}

TEST(CameraRotation, KeepsZUpwards) {
  const Quat rotation = camera_rotation({1, 2, 3}, {-4, 1, 0});
  const Vec3 right = rotation * Vec3::UnitX(), up = rotation * Vec3::UnitY(),
             forward = rotation * -Vec3::UnitZ();
  EXPECT_NEAR(right.z(), 0.0, 1e-12);
  EXPECT_GT(up.z(), 0.0);
  EXPECT_LT((forward - Vec3(-5, -1, -3).normalized()).norm(), 1e-12);
}

}  // namespace
}  // namespace lodestone
