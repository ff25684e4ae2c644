#include "tools/methods/method_world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "tests/message_of.h"
#include "tests/tools/methods/box_job.h"

namespace lodestone {
namespace {

using testing::box_job;

RigidState above_the_plane(double height_m) {
  return {.position = Vec3(0.0, 0.0, height_m), .orientation = Quat(1.0, 0.2, 0.3, 0.1).normalized()};
}

// One of each engine, none of which needs a signature.
std::vector<Method> methods_of_every_engine(const DropJob& job) {
  std::vector<Method> methods =
      make_methods({"full_1", "waiting", "bullet_hull", "bullet_hull40"}, job, {}, 1, {});
  std::erase_if(methods, [](const Method& method) { return !method.left_out.empty(); });
  return methods;
}

WorldSettings on_a_plane() { return {.planes = {{Vec3::UnitZ(), 0.0}}}; }

RigidState after_a_second(MethodWorld& world) {
  for (int i = 0; i < 60; ++i) world.step(1.0 / 60.0);
  return world.state();
}

TEST(MethodWorld, EveryEngineLetsBodiesFallOntoThePlane) {
  const DropJob job = box_job();
  const std::array starts = {above_the_plane(0.5), above_the_plane(3.0)};
  for (const Method& method : methods_of_every_engine(job)) {
    MethodWorld world(job, method, on_a_plane(), starts);
    ASSERT_EQ(world.bodies(), 2) << method.name;
    EXPECT_EQ(world.awake(), 2) << method.name;
    const double low = after_a_second(world).position.z();
    EXPECT_GT(low, 0.09) << method.name;  // half of the least side, but for what contacts give
    EXPECT_LT(low, 0.5) << method.name;
    EXPECT_LT(world.state(1).position.z(), 3.0 - 1.0) << method.name;
  }
}

TEST(MethodWorld, WithoutPlanesAndGravityNothingChangesItsVelocity) {
  const DropJob job = box_job();
  RigidState start = above_the_plane(0.0);
  start.velocity = Vec3(0.5, -1.0, 0.25);
  for (const Method& method : methods_of_every_engine(job)) {
    MethodWorld world(job, method, {.gravity = Vec3::Zero(), .sleeping = false}, {&start, 1});
    EXPECT_LT((after_a_second(world).velocity - start.velocity).norm(), 1e-6) << method.name;
  }
}

TEST(MethodWorld, RestartedItIsAsMadeAnew) {
  const DropJob job = box_job();
  const RigidState first = above_the_plane(0.4), second = above_the_plane(0.6);
  for (const Method& method : methods_of_every_engine(job)) {
    MethodWorld used(job, method, on_a_plane(), {&first, 1});
    after_a_second(used);
    used.restart(1, {&second, 1});
    ASSERT_EQ(used.bodies(), 1) << method.name;
    MethodWorld fresh(job, method, on_a_plane(), {&second, 1});
    EXPECT_EQ(after_a_second(used).position, after_a_second(fresh).position) << method.name;
    EXPECT_EQ(used.state().angular_velocity, fresh.state().angular_velocity) << method.name;
  }
}

TEST(MethodWorld, ShowsTheEngineThatItHas) {
  const DropJob job = box_job();
  const RigidState start = above_the_plane(0.5);
  for (const Method& method : methods_of_every_engine(job)) {
    const MethodWorld world(job, method, on_a_plane(), {&start, 1});
    EXPECT_EQ(world.ode() != nullptr, method.name == "full_1") << method.name;
    EXPECT_EQ(world.manager() != nullptr, method.name == "waiting") << method.name;
  }
}

// At its start, and again after others were there.
TEST(MethodWorld, OnBoxesAndMeshesBodiesRestAsHighAsInOde) {
  const DropJob job = box_job();
  const Method ode = make_methods({"full_1"}, job, {}, 1, {})[0],
               statistical = make_methods({"waiting"}, job, {}, 1, {})[0];
  for (const auto& [ground, name] : kUnevenGrounds) {
    const WorldSettings settings{.solids = make_drop_ground(ground, job.shape->size)};
    RigidState start = above_the_plane(0.9);
    start.position.x() = -1.5;  // over the landing of the stairs
    MethodWorld truth(job, ode, settings, {&start, 1}), world(job, statistical, settings, {&start, 1});
    const auto height = [](MethodWorld& of) {
      for (int i = 0; i < 240; ++i) of.step(1.0 / 60.0);
      return of.state().position.z();
    };
    const double first = height(world);
    EXPECT_NEAR(first, height(truth), 0.11) << name;  // it may lie on another of its sides
    world.restart(1, {&start, 1});
    ASSERT_EQ(world.bodies(), 1) << name;
    EXPECT_NEAR(height(world), first, 1e-6) << name;
  }
}

// A series goes on without it.
TEST(MethodWorld, BulletIsLeftOutWhereThereAreMoreThanPlanes) {
  DropJob job = box_job();
  job.ground = DropGround::tiles;
  for (const Method& method : make_methods({"full_1", "bullet_hull"}, job, {}, 1, {}))
    EXPECT_EQ(method.left_out.empty(), method.name == "full_1") << method.name << ": " << method.left_out;
}

TEST(MethodWorld, BulletRefusesGroundThatItIsNotComparedOn) {
  if (!bullet_available()) GTEST_SKIP() << "built without Bullet";
  const DropJob on_plane = box_job();
  const Method bullet = make_methods({"bullet_hull"}, on_plane, {}, 1, {})[0];
  const RigidState start = above_the_plane(0.5);
  const std::string message = testing::message_of<InputError>([&] {
    MethodWorld(on_plane, bullet, {.solids = make_drop_ground(DropGround::tiles, 0.4)}, {&start, 1});
  });
  EXPECT_EQ(message, "ground of bullet: found boxes or meshes, expected planes, all that it is compared on");
}

}  // namespace
}  // namespace lodestone
