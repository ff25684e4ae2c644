#include "reference/hull/hull_overlap.h"

#include <gtest/gtest.h>

#include "reference/random.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

TEST(HullOverlap, IsTheDepthWhereFacesOverlapALittle) {
  const auto box = box_shape({0.2, 0.3, 0.4});
  for (const double depth : {1e-5, 1e-3, 5e-3})
    EXPECT_NEAR(measure_hull_overlap(*box, at({7, 0, 0.2}), *box, at({7.02, 0.01, 0.6 - depth})), depth,
                1e-3 * depth + 1e-9);
}

TEST(HullOverlap, IsZeroApart) {
  const auto box = box_shape({0.2, 0.3, 0.4});
  EXPECT_EQ(measure_hull_overlap(*box, at({0, 0, 0}), *box, at({0.05, 0.1, 0.4001})), 0.0);
  EXPECT_EQ(measure_hull_overlap(*box, at({0, 0, 0}), *box, at({3, 0, 0})), 0.0);
  EXPECT_FALSE(may_hulls_overlap(*box, at({0, 0, 0}), *box, at({0.05, 0.1, 0.41})));
  EXPECT_TRUE(may_hulls_overlap(*box, at({0, 0, 0}), *box, at({0.05, 0.1, 0.39})));
}

// A crate that stands on a slab to the bit, anywhere on it, or sinks in by a little.
TEST(HullOverlap, TouchingIsNoOverlapWhereverItIs) {
  const auto crate = box_shape({0.4, 0.4, 0.4});
  for (const Vec3& sides : {Vec3(4, 4, 0.2), Vec3(1, 1, 1), Vec3(60, 20, 0.5)}) {
    const auto slab = box_shape(sides);
    for (int i = 0; i < 400; ++i) {
      const double x = (i % 20 - 9.5) / 20 * sides.x(), y = (i / 20 - 9.5) / 20 * sides.y();
      for (const double depth : {0.0, 1e-12, 1e-6, 1e-2}) {
        const double found =
            measure_hull_overlap(*crate, at({x, y, 0.2 - depth}), *slab, at({0, 0, -sides.z() / 2}));
        EXPECT_LE(found, depth + 1e-12) << x << " " << y << " on " << sides.transpose();
        EXPECT_LE(measure_hull_overlap(*slab, at({0, 0, -sides.z() / 2}), *crate, at({x, y, 0.2 - depth})),
                  depth + 1e-12);
      }
    }
  }
}

TEST(HullOverlap, T2HullWhollyInsideAnotherOverlaps) {
  const auto large = box_shape({2, 2, 2}), small = box_shape({0.1, 0.1, 0.1});
  EXPECT_GE(measure_hull_overlap(*large, at({0, 0, 0}), *small, at({0.3, 0, 0})), 0.75);
  EXPECT_GE(measure_hull_overlap(*small, at({0, 0, 0}), *large, at({0, 0, 0})), 1.05 * (1 - 1e-6));
}

TEST(HullOverlap, SpheresOverlapByTheirRadii) {
  const auto ball = sphere_shape(0.1);
  EXPECT_NEAR(measure_hull_overlap(*ball, at({0, 0, 0}), *ball, at({0.1, 0.1, 0.1})),
              0.2 - 0.1 * std::sqrt(3.0), 1e-4);
  EXPECT_EQ(measure_hull_overlap(*ball, at({0, 0, 0}), *ball, at({0.2001, 0, 0})), 0.0);
}

// Of random poses: no overlap is reported where some direction separates the hulls, and a reported depth is
// one that parts them.
TEST(HullOverlap, AgreesWithASweepOfDirections) {
  const auto box = box_shape({0.2, 0.3, 0.4});
  int overlapping = 0;
  for (std::uint32_t trial = 0; trial < 200; ++trial) {
    RandomStream random(1, trial, 0);
    const RigidState a = at(Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), random.orientation());
    const RigidState b = at(0.25 * random.direction(), Vec3::Zero(), Vec3::Zero(), random.orientation());
    double least = 1.0;
    for (int i = 0; i < 5000; ++i) {
      const Vec3 direction = random.direction();
      double top_of_a = -1, bottom_of_b = 1;
      for (const Vec3& v : box->hull.vertices) {
        top_of_a = std::max(top_of_a, direction.dot(a.orientation * v));
        bottom_of_b = std::min(bottom_of_b, direction.dot(b.position + b.orientation * v));
      }
      least = std::min(least, top_of_a - bottom_of_b);
    }
    const double depth = measure_hull_overlap(*box, a, *box, b);
    if (least < 0.0) {
      EXPECT_EQ(depth, 0.0) << trial;
    } else if (least > 0.01) {  // the sweep is not exact
      EXPECT_GT(depth, 0.9 * least - 0.01) << trial;
      ++overlapping;
    }
  }
  EXPECT_GT(overlapping, 20);
}

TEST(PlaneOverlap, IsTheDepthOfTheLowestPoint) {
  const auto box = box_shape({0.2, 0.3, 0.4});
  EXPECT_NEAR(measure_plane_overlap(*box, at({3, 4, 0.19}), Vec3::UnitZ(), 0.0), 0.01, 1e-12);
  EXPECT_NEAR(measure_plane_overlap(*box, at({1.3, 0, 0}), -Vec3::UnitX(), -1.5), -0.1, 1e-12);
}

}  // namespace
}  // namespace lodestone
