#include "scenes/run_measures.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "reference/random.h"

namespace lodestone {
namespace {

TEST(KineticEnergy, MatchesTheSumOverPoints) {
  const Shape box = make_shape("box", make_box({1, 2, 3}));
  RigidState state;
  state.orientation = RandomStream(1, 2, 3).orientation();
  state.velocity = {1, -2, 3};
  state.angular_velocity = {-3, 1, 2};
  double sum = 0;  // midpoints of a grid of cells
  constexpr int n = 30;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) {
        const Vec3 local((i + 0.5) / n - 0.5, 2 * ((j + 0.5) / n - 0.5), 3 * ((k + 0.5) / n - 0.5));
        const Vec3 v = state.velocity + state.angular_velocity.cross(state.orientation * local);
        sum += 0.5 * v.squaredNorm() / (n * n * n);
      }
  EXPECT_NEAR(kinetic_energy(box, 5.0, state), 5.0 * sum, 2e-3 * 5.0 * sum);
}

TEST(DepthBelow, IsThatOfTheDeepestVertex) {
  const Shape l = make_shape("l", make_l(0.3, 0.2, 0.05, 0.04));
  const Vec3 normal = Vec3(0.1, -0.2, 1).normalized();
  RandomStream stream(4, 0, 0);
  for (int i = 0; i < 200; ++i) {
    RigidState state;
    state.orientation = stream.orientation();
    state.position = stream.direction() * 0.2;
    double deepest = -1e9;
    for (const Vec3& vertex : l.mesh.vertices)
      deepest = std::max(deepest, 0.05 - normal.dot(state.position + state.orientation * vertex));
    if (normal.dot(state.position) - 0.05 > l.radius)
      EXPECT_LE(deepest, 0);
    else
      EXPECT_NEAR(depth_below(l, state, normal, 0.05), deepest, 1e-12);
  }
}

TEST(DepthBelow, SphereIsExactAndHighBodiesAreClear) {
  RigidState state;
  state.position = {0, 0, 0.09};
  EXPECT_NEAR(depth_below(make_sphere_shape(0.1), state, Vec3::UnitZ(), 0), 0.01, 1e-12);
  state.position.z() = 7;
  EXPECT_LT(depth_below(make_shape("box", make_box({1, 1, 1})), state, Vec3::UnitZ(), 0), -6);
}

TEST(IsFinite, FindsEachPart) {
  EXPECT_TRUE(is_finite(RigidState{}));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  RigidState a, b, c, d;
  a.position.x() = b.velocity.y() = c.angular_velocity.z() = d.orientation.w() = nan;
  for (const RigidState& state : {a, b, c, d}) EXPECT_FALSE(is_finite(state));
}

// By the vertices that are inside, from the nearest face, whichever way the box is turned.
TEST(Depth, InABoxIsThatOfTheDeepestVertex) {
  const Shape cube = make_shape("cube", make_box({0.2, 0.2, 0.2}));
  const Quat turned = rotation_from_vector({0.3, -0.5, 0.8});
  const RigidState box{.position = {1, 2, 3}, .orientation = turned};
  const auto at_height = [&](double z) {
    return RigidState{.position = box.position + turned * Vec3(0.1, 0.2, z), .orientation = turned};
  };
  const Vec3 sides(2, 2, 1);
  EXPECT_NEAR(depth_in_box(cube, at_height(0.57), sides, box), 0.03, 1e-12);
  EXPECT_LT(depth_in_box(cube, at_height(0.61), sides, box), 0.0);
  EXPECT_LT(depth_in_box(cube, at_height(20.0), sides, box), 0.0);
  EXPECT_NEAR(depth_in_box(make_sphere_shape(0.1), at_height(0.56), sides, box), 0.04, 1e-12);
}

// Its surface at a distance d from an edge or a corner, along the way out between the faces: −d, and not what
// it would be from one of them.
TEST(Depth, OfABallBesideAnEdgeOrACornerIsItsDistance) {
  const Shape ball = make_sphere_shape(0.5);
  const Vec3 sides(2, 2, 2);
  const auto depth_at = [&](const Vec3& position) {
    return depth_in_box(ball, {.position = position}, sides, RigidState{});
  };
  EXPECT_NEAR(depth_at({1.3, 0, 1.4}), 0.0, 1e-12);
  EXPECT_NEAR(depth_at({-1.6, 1.8, 0.9}), -0.5, 1e-12);
  EXPECT_NEAR(depth_at({1.2, 1.1, -1.2}), 0.2, 1e-12);
  EXPECT_NEAR(depth_at({0.9, 0, 0.8}), 0.6, 1e-12);  // its middle inside
}

}  // namespace
}  // namespace lodestone
