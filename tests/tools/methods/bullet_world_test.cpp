#include "tools/methods/bullet_world.h"

#include <gtest/gtest.h>

#include "reference/random.h"

namespace lodestone {
namespace {

class Bullet : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!bullet_available()) GTEST_SKIP() << "built without Bullet";
  }
  static std::shared_ptr<const Shape> share(Shape shape) {
    return std::make_shared<const Shape>(std::move(shape));
  }
};

TEST_F(Bullet, FliesInAParabola) {
  BulletWorld world({});
  const int body = world.add_body({.shape = share(make_shape("l", make_l(0.3, 0.2, 0.08, 0.1))),
                                   .state = {.position = {0, 0, 10}, .velocity = {1, 0, 2}}});
  for (int i = 0; i < 100; ++i) world.step(0.01);
  EXPECT_NEAR(world.state(body).position.x(), 1.0, 1e-4);
  EXPECT_NEAR(world.state(body).position.z(), 10.0 + 2.0 - 0.5 * 9.81, 0.06);  // first order in the step
}

// Its principal axes are not the mesh's: the state must come back as it was given.
TEST_F(Bullet, GivesBackTheStateThatItWasGiven) {
  BulletWorld world({});
  RandomStream random(1, 0, 0);
  const RigidState state{{1, 2, 3}, random.orientation(), {1, 0, 0}, {0, 1, 0}};
  const int body = world.add_body({.shape = share(make_bunny_shape(0.2, 500)), .state = state});
  EXPECT_LT((world.state(body).position - state.position).norm(), 1e-6);
  EXPECT_LT(world.state(body).orientation.angularDistance(state.orientation), 1e-3);
  EXPECT_LT((world.state(body).angular_velocity - state.angular_velocity).norm(), 1e-6);
}

TEST_F(Bullet, BoxComesToRestOnThePlane) {
  BulletWorld world({});
  const Material material{.restitution = 0.0, .friction = 0.5};
  world.add_plane(Vec3::UnitZ(), 0.0, material);
  const int body = world.add_body({.shape = share(make_shape("box", make_box({0.2, 0.3, 0.4}))),
                                   .mass = 24.0,
                                   .material = material,
                                   .state = {.position = {0, 0, 0.3}}});
  for (int i = 0; i < 200; ++i) world.step(1.0 / 60);
  EXPECT_NEAR(world.state(body).position.z(), 0.2, 2e-3);
  EXPECT_LT(world.state(body).velocity.norm(), 1e-2);
}

TEST_F(Bullet, RestitutionIsTheLowerOfThePair) {
  BulletWorld world({});
  world.add_plane(Vec3::UnitZ(), 0.0, {.restitution = 1.0, .friction = 0.0});
  const int body = world.add_body({.shape = share(make_sphere_shape(0.1)),
                                   .material = {.restitution = 0.5, .friction = 0.0},
                                   .state = {.position = {0, 0, 1.1}}});
  double highest = 0.0;
  bool bounced = false;
  for (int i = 0; i < 1000; ++i) {
    world.step(1e-3);
    bounced = bounced || world.state(body).velocity.z() > 0.0;
    if (bounced) highest = std::max(highest, world.state(body).position.z());
  }
  EXPECT_NEAR(highest, 0.1 + 0.25, 0.04);  // Bullet itself ends a little lower
}

}  // namespace
}  // namespace lodestone
