#include "lod/statistical/statistical_body.h"

#include <gtest/gtest.h>

#include "reference/random.h"
#include "tests/prism.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

// Turned into its principal axes, the inverse inertia is diagonal with the moments, ascending.
TEST(BodyKind, PrincipalAxesDiagonalizeTheInertia) {
  RandomStream random(51, 0, 0);
  for (int i = 0; i < 40; ++i) {
    Mesh mesh = make_box({random.uniform(0.1, 1), random.uniform(0.1, 1), random.uniform(0.1, 1)});
    const Quat turn = random.orientation();
    for (Vec3& vertex : mesh.vertices) vertex = turn * vertex;
    const auto shape = std::make_shared<const Shape>(make_shape("turned", mesh));
    const BodyKind kind = make_body_kind(shape);
    const Mat3 axes = kind.principal_axes.toRotationMatrix();
    EXPECT_NEAR(axes.determinant(), 1.0, 1e-12);
    const Mat3 diagonal = axes.transpose() * shape->inverse_inertia_per_mass * axes;
    EXPECT_LT((diagonal - Mat3(kind.inverse_moments.asDiagonal())).norm(), 1e-9 * diagonal.norm());
    EXPECT_LE(kind.inverse_moments[0], kind.inverse_moments[1]);
    EXPECT_LE(kind.inverse_moments[1], kind.inverse_moments[2]);
    EXPECT_FALSE(kind.isotropic);
  }
}

TEST(BodyKind, CubesAndBallsAreIsotropicAndBallsRound) {
  const BodyKind cube = make_body_kind(testing::box_shape({0.3, 0.3, 0.3})),
                 ball = make_body_kind(testing::sphere_shape(0.3)),
                 box = make_body_kind(testing::box_shape({0.3, 0.3, 0.301}));
  EXPECT_TRUE(cube.isotropic && ball.isotropic);
  EXPECT_FALSE(box.isotropic);
  EXPECT_TRUE(ball.round);
  EXPECT_FALSE(cube.round || box.round);
}

// A signature of a body that always collides as high as its bounding sphere makes it round.
TEST(BodyKind, IsRoundByItsCollisionHeights) {
  for (const float least : {0.94f, 0.96f}) {
    auto signature = std::make_shared<Signature>();
    signature->collision_heights.mean = {0.99f, least, 1.0f};
    const BodyKind kind = make_body_kind(testing::box_shape({0.3, 0.3, 0.3}), signature, 4);
    EXPECT_EQ(kind.round, least > 0.95f);
    EXPECT_EQ(kind.material, 4);
    EXPECT_EQ(kind.signature, signature);
  }
}

TEST(BodyKind, WhatRollsOverSmallSidesIsNotAngular) {
  const auto is_angular = [](std::shared_ptr<const Shape> shape) {
    return make_body_kind(std::move(shape)).angular;
  };
  EXPECT_TRUE(is_angular(testing::box_shape({0.2, 0.3, 0.4})));
  EXPECT_TRUE(is_angular(testing::make_prism(8, 0.12, 0.3)));
  EXPECT_FALSE(is_angular(testing::make_prism(12, 0.12, 0.06)));  // a coin, whose edges are long
  EXPECT_FALSE(is_angular(testing::make_prism(48, 0.12, 0.3)));
  EXPECT_FALSE(is_angular(testing::make_prism(8, 0.01, 0.3)));  // a needle
  EXPECT_FALSE(is_angular(testing::sphere_shape(0.3)));
}

TEST(StatisticalBody, KineticEnergyIsThatOfThePointsOfTheBody) {
  RandomStream random(52, 0, 0);
  const auto shape = testing::box_shape({0.2, 0.3, 0.4});
  for (int i = 0; i < 50; ++i) {
    StatisticalBody body;
    body.orientation = random.orientation(), body.velocity = random.uniform(0, 3) * random.direction();
    const Vec3 turning = random.uniform(0, 10) * random.direction();
    body.spin = spin_of(body.orientation, turning, *shape);
    // Half of the mean of |v + ω × r|² over a box, whose second moments are known.
    const Vec3 local = body.orientation.conjugate() * turning, sides(0.2, 0.3, 0.4);
    double turns = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const int b = (axis + 1) % 3, c = (axis + 2) % 3;
      turns += local[axis] * local[axis] * (sides[b] * sides[b] + sides[c] * sides[c]) / 12.0;
    }
    EXPECT_NEAR(kinetic_energy(body, *shape), 0.5 * (body.velocity.squaredNorm() + turns), 1e-9);
  }
}

}  // namespace
}  // namespace lodestone
