#include "lod/ground/half_space.h"

#include <gtest/gtest.h>

#include "reference/random.h"

namespace lodestone {
namespace {

TEST(HalfSpace, HeightIsTheDistanceAlongTheNormal) {
  RandomStream random(2, 0, 0);
  for (int i = 0; i < 100; ++i) {
    const HalfSpace plane{.normal = random.direction(), .offset = random.uniform(-5, 5)};
    const double height = random.uniform(-3, 3);
    const Vec3 on_it = plane.offset * plane.normal + 2.0 * plane.normal.unitOrthogonal();
    EXPECT_NEAR(plane.height_of(on_it), 0.0, 1e-12);
    EXPECT_NEAR(plane.height_of(on_it + height * plane.normal), height, 1e-12);
    // Turned along with the point, or moved along with it: the same.
    const Quat turn = random.orientation();
    const HalfSpace turned{.normal = turn * plane.normal, .offset = plane.offset};
    const Vec3 place = 3.0 * random.direction();
    EXPECT_NEAR(turned.height_of(turn * place), plane.height_of(place), 1e-12);
    const Vec3 away = random.direction();
    const HalfSpace moved{.normal = plane.normal, .offset = plane.offset + plane.normal.dot(away)};
    EXPECT_NEAR(moved.height_of(place + away), plane.height_of(place), 1e-12);
  }
}

TEST(HalfSpace, WithoutMoreIsTheFloor) {
  EXPECT_EQ(HalfSpace{}.height_of({4, 5, 6}), 6.0);
  EXPECT_EQ(HalfSpace{}.material, 0);
  EXPECT_FALSE(HalfSpace{}.id);
}

}  // namespace
}  // namespace lodestone
