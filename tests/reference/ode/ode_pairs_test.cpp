// Bodies that meet each other: stacks, concave shapes, sleep, and worlds beside each other.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <thread>

#include "reference/error.h"
#include "reference/hull/hull_overlap.h"
#include "reference/random.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

struct Stack {
  std::shared_ptr<const Shape> shape;
  std::unique_ptr<OdeWorld> world;
  std::vector<OdeBodyId> bodies;
};

// Cubes on one another, each turned about the vertical and moved aside a little, dropped by a thousandth of
// their side.
Stack make_stack(const MaterialTable& materials, const Mesh& cube, double side, int count,
                 const OdeSettings& settings = {}) {
  Stack stack{std::make_shared<const Shape>(make_shape("cube", cube)),
              std::make_unique<OdeWorld>(settings, materials),
              {}};
  stack.world->add_plane(Vec3::UnitZ(), 0.0, 0);
  for (int i = 0; i < count; ++i) {
    RandomStream random(7, i, 0);
    const Quat turned(Eigen::AngleAxisd(random.uniform(-0.3, 0.3), Vec3::UnitZ()));
    const Vec3 position(random.uniform(-0.03, 0.03) * side, 0.0, side * (0.5 + i + 1e-3 * (i + 1)));
    stack.bodies.push_back(
        stack.world->add_body({.shape = stack.shape,
                               .mass = 1000.0 * stack.shape->volume,
                               .state = at(position, Vec3::Zero(), Vec3::Zero(), turned)}));
  }
  return stack;
}

Mesh subdivide(const Mesh& mesh) {
  Mesh fine;
  for (const auto& face : mesh.faces) {
    const int first = int(fine.vertices.size());
    for (const int i : face) fine.vertices.push_back(mesh.vertices[i]);
    for (int i = 0; i < 3; ++i)
      fine.vertices.push_back(0.5 * (mesh.vertices[face[i]] + mesh.vertices[face[(i + 1) % 3]]));
    for (const auto& f : {std::array{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}})
      fine.faces.push_back({first + f[0], first + f[1], first + f[2]});
  }
  return fine;
}

// Hard case F7, small: plain ODE throws the top cube off in 14 of 15 such stacks.
class TrimeshStack : public ::testing::TestWithParam<std::tuple<int, double, double, bool>> {};

TEST_P(TrimeshStack, Stands) {
  const auto [count, side, dt, fine] = GetParam();
  const MaterialTable materials = material(0.0, 0.5);
  const Mesh cube = make_box(Vec3::Constant(side));
  Stack stack = make_stack(materials, fine ? subdivide(subdivide(cube)) : cube, side, count);
  const Vec3 start = stack.world->state(stack.bodies.back()).position;
  double top_speed = 0.0;
  for (int i = 0; i < int(2.0 / dt); ++i) {
    stack.world->step(dt);
    for (const OdeBodyId body : stack.bodies)
      top_speed = std::max(top_speed, stack.world->state(body).velocity.norm());
  }
  const RigidState end = stack.world->state(stack.bodies.back());
  EXPECT_NEAR(end.position.z(), side * (count - 0.5), 2e-3 * side);
  EXPECT_LT((end.position - start).head<2>().norm(), 0.04 * side);
  EXPECT_LT(end.velocity.norm(), 0.02);
  EXPECT_LT(top_speed, 1.5 * std::sqrt(2.0 * kGravity * side * 1e-3 * count) + kGravity * dt * count);
}

INSTANTIATE_TEST_SUITE_P(OdePairs, TrimeshStack,
                         ::testing::Combine(::testing::Values(2, 5), ::testing::Values(1.0, 0.2),
                                            ::testing::Values(1.0 / 60, 1.0 / 100, 1.0 / 500),
                                            ::testing::Values(false, true)));

// Hard case F14.
TEST(OdePairs, StackStandsFarFromTheOrigin) {
  const MaterialTable materials = material(0.0, 0.5);
  double rest[2];
  for (const bool far : {false, true}) {
    Stack stack = make_stack(materials, make_box(Vec3::Constant(0.5)), 0.5, 5);
    for (const OdeBodyId body : stack.bodies) {
      RigidState state = stack.world->state(body);
      state.position.head<2>().array() += far ? 1e7 : 0.0;
      stack.world->set_state(body, state);
    }
    for (int i = 0; i < 100; ++i) stack.world->step(1.0 / 100);
    rest[far] = stack.world->state(stack.bodies.back()).position.z();
  }
  EXPECT_NEAR(rest[0], rest[1], 1e-5);
}

// Two spheres head-on without friction: momentum and, at restitution one, energy are kept (hard case F18).
TEST(OdePairs, ElasticSpheresExchangeMomentum) {
  const MaterialTable materials = material(1.0, 0.0);
  OdeWorld world({.gravity = Vec3::Zero(), .cfm = 0.0}, materials);
  const auto ball = sphere_shape(0.1);
  const OdeBodyId a = world.add_body({.shape = ball, .mass = 1.0, .state = at({-0.3, 0, 0}, {1, 0, 0})});
  const OdeBodyId b = world.add_body({.shape = ball, .mass = 3.0, .state = at({0.3, 0, 0}, {-1, 0, 0})});
  for (int i = 0; i < 1000; ++i) world.step(1e-3);
  EXPECT_NEAR(world.state(a).velocity.x(), -2.0, 1e-9);
  EXPECT_NEAR(world.state(b).velocity.x(), 0.0, 1e-9);
}

// An L standing in the corner of a second one must be held by the floor leg and by the wall leg at once.
TEST(OdePairs, BoxPushedIntoTheCornerOfAnLIsHeldByBothLegs) {
  const MaterialTable materials = material(0.0, 0.3);
  OdeWorld world({}, materials);
  const auto l = std::make_shared<const Shape>(make_shape("l", make_l(1.0, 1.0, 0.2, 1.0)));
  const auto box = box_shape({0.3, 0.3, 0.3});
  // Stood up: leg a along x is the floor, leg b the wall; the inner corner is at inner.
  const Quat upright(Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitX()));
  const OdeBodyId base = world.add_body(
      {.shape = l, .mass = 1e6, .state = at(Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), upright)});
  world.set_asleep(base, true);
  const Vec3 corner = upright * (Vec3(-0.3, -0.3, 0.0) - l->center_of_mass_in_mesh);
  const OdeBodyId body =
      world.add_body({.shape = box, .mass = 27.0, .state = at(corner + Vec3(0.2, 0.0, 0.2))});
  for (int i = 0; i < 2000; ++i) {
    world.set_state(base, at(Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), upright));
    world.add_force(body, {-500, 0, 0}, Vec3::Zero());
    world.step(1e-3);
  }
  const Vec3 rest = world.state(body).position - corner;
  EXPECT_NEAR(rest.x(), 0.15, 2e-3);
  EXPECT_NEAR(rest.z(), 0.15, 2e-3);
  EXPECT_LT(world.state(body).velocity.norm(), 0.02);
}

// Hard case T2 and pitfall 4: surfaces that do not cross make no contact of their own.
TEST(OdePairs, ABodyWhollyInsideAnotherIsNoticedAndPushedOut) {
  const MaterialTable materials = material(0.0, 0.3);
  OdeWorld world({.gravity = Vec3::Zero(), .max_correcting_velocity = 1.0}, materials);
  const auto large = std::make_shared<const Shape>(make_bunny_shape(1.0, 500)),
             small = box_shape({0.1, 0.1, 0.1});
  const OdeBodyId around = world.add_body({.shape = large, .mass = 100.0});
  const OdeBodyId inside = world.add_body({.shape = small, .mass = 1.0});  // at the bunny's centre of mass
  world.step(1.0 / 240);
  EXPECT_EQ(world.counters().swallowed, 1);
  double top_speed = 0.0;
  for (int i = 0; i < 480; ++i) {
    world.step(1.0 / 240);
    top_speed = std::max(top_speed, world.state(inside).velocity.norm());
  }
  EXPECT_FALSE(find_hull_overlap(*large, world.state(around), *small, world.state(inside)));
  EXPECT_LT(top_speed,
            std::numbers::sqrt3 +
                0.05);  // by contacts that do not oppose each other, each at the correcting velocity
}

// As where it was put there: ODE's ball meets no face that its centre is behind.
TEST(OdePairs, ABallWhoseCenterIsInABodyIsNoticedAndPushedOut) {
  const MaterialTable materials = material(0.0, 0.3);
  const auto cube = box_shape({0.3, 0.3, 0.3}), ball = sphere_shape(0.15);
  for (const bool ball_first : {false, true}) {
    OdeWorld world({.gravity = Vec3::Zero(), .max_correcting_velocity = 1.0}, materials);
    const auto add = [&](bool is_ball) {
      return world.add_body({.shape = is_ball ? ball : cube,
                             .mass = is_ball ? 1.0 : 100.0,
                             .state = at(is_ball ? Vec3(0.01, 0.02, 0.1) : Vec3::Zero())});
    };
    const OdeBodyId one = add(ball_first), other = add(!ball_first);
    world.step(1.0 / 240);
    EXPECT_EQ(world.counters().swallowed, 1);
    for (int i = 0; i < 240; ++i) world.step(1.0 / 240);
    const Vec3 between =
        world.state(ball_first ? one : other).position - world.state(ball_first ? other : one).position;
    EXPECT_GT(between.z(), 0.298);
    EXPECT_LT(between.head<2>().norm(), 0.1);
  }
}

TEST(OdePairs, SupportRemovedWakesWhatItHeld) {
  const MaterialTable materials = material(0.0, 0.5);
  Stack stack = make_stack(materials, make_box(Vec3::Constant(0.5)), 0.5, 3, {.auto_disable = true});
  for (int i = 0; i < 300; ++i) stack.world->step(1.0 / 60, 2);
  for (const OdeBodyId body : stack.bodies) ASSERT_TRUE(stack.world->asleep(body));
  const double before = stack.world->state(stack.bodies[1]).position.z();
  stack.world->remove_body(stack.bodies[0]);
  EXPECT_FALSE(stack.world->asleep(stack.bodies[1]));
  for (int i = 0; i < 60; ++i) stack.world->step(1.0 / 60, 2);
  EXPECT_NEAR(stack.world->state(stack.bodies[1]).position.z(), before - 0.5, 0.02);
  EXPECT_NEAR(stack.world->state(stack.bodies[2]).position.z(), before, 0.02);
}

// Hard case F16, small.
TEST(OdePairs, SleepingWorldKeepsItsBitsAndWakesWhenAsked) {
  const MaterialTable materials = material(0.0, 0.5);
  Stack stack = make_stack(materials, make_box(Vec3::Constant(0.5)), 0.5, 3, {.auto_disable = true});
  for (int i = 0; i < 300; ++i) stack.world->step(1.0 / 60, 2);
  const RigidState before = stack.world->state(stack.bodies[2]);
  for (int i = 0; i < 1000; ++i) stack.world->step(1.0 / 60, 2);
  EXPECT_TRUE(same_bits(stack.world->state(stack.bodies[2]), before));
  EXPECT_TRUE(stack.world->contacts().empty());
  stack.world->add_force(stack.bodies[2], {1e5, 0, 0},
                         Vec3::Zero());  // lost: it does not wake, and lasts one step
  stack.world->step(1.0 / 60);
  stack.world->set_asleep(stack.bodies[2], false);
  stack.world->step(1.0 / 60);
  EXPECT_FALSE(stack.world->contacts().empty());
  EXPECT_LT(stack.world->state(stack.bodies[2]).velocity.norm(), 0.2);
}

// Boxes exactly on boxes: contacts tie, and at such ties ODE's solver drops every contact of the pile.
TEST(OdePairs, AlignedPileFallsAsleepAndStands) {
  const MaterialTable materials = material(0.0, 0.5);
  OdeWorld world({.auto_disable = true}, materials);
  world.add_plane(Vec3::UnitZ(), 0.0, 0);
  const auto shape = box_shape(Vec3::Constant(0.3));
  std::vector<OdeBodyId> bodies;
  for (int i = 0; i < 12; ++i)
    bodies.push_back(world.add_body(
        {.shape = shape, .mass = 27.0, .state = at({0.4 * (i % 4), 0, 0.16 + 0.31 * (i / 4)})}));
  for (int i = 0; i < 120; ++i) world.step(1.0 / 60, 2);
  for (int i = 0; i < 12; ++i) {
    EXPECT_TRUE(world.asleep(bodies[i])) << i;
    EXPECT_NEAR(world.state(bodies[i]).position.z(), 0.15 + 0.3 * (i / 4), 1e-3) << i;
  }
}

// Without any softness ODE's solver gives up on stacked boxes again and again, and says so.
TEST(OdePairs, SolverFailuresAreCountedQuietAndRepaired) {
  const MaterialTable materials = material(0.0, 0.5);
  Stack stack = make_stack(materials, make_box(Vec3::Constant(0.5)), 0.5, 4, {.cfm = 0.0});
  ::testing::internal::CaptureStderr();
  for (int i = 0; i < 200; ++i) stack.world->step(1.0 / 100);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  EXPECT_GT(stack.world->counters().messages, 0);
  EXPECT_NEAR(stack.world->state(stack.bodies.back()).position.z(), 0.5 * 3.5, 2e-3);
}

RigidState run_pile(std::uint32_t which) {
  const MaterialTable materials;
  OdeWorld world({}, materials);
  world.add_plane(Vec3::UnitZ(), 0.0, 0);
  const auto shape = box_shape({0.2, 0.3, 0.4});
  std::vector<OdeBodyId> bodies;
  for (std::uint32_t i = 0; i < 6; ++i) {
    RandomStream random(5, i, which);
    bodies.push_back(world.add_body({.shape = shape,
                                     .mass = 24.0,
                                     .state = at({random.uniform(0, 0.2), 0, 0.3 + 0.4 * i}, Vec3::Zero(),
                                                 Vec3::Zero(), random.orientation())}));
  }
  for (int i = 0; i < 60; ++i) world.step(1.0 / 60, 4);
  return world.state(bodies.front());
}

TEST(OdePairs, WorldsOnTwoThreadsGiveTheBitsTheyGiveAlone) {
  const RigidState alone[2] = {run_pile(0), run_pile(1)};
  RigidState together[2];
  {
    const std::jthread first([&] { together[0] = run_pile(0); });
    const std::jthread second([&] { together[1] = run_pile(1); });
  }
  EXPECT_TRUE(same_bits(alone[0], together[0]));
  EXPECT_TRUE(same_bits(alone[1], together[1]));
  EXPECT_FALSE(same_bits(alone[0], alone[1]));
}

TEST(OdePairs, QuickStepRepeatsBesideAnotherWorld) {
  const MaterialTable materials;
  const auto run = [&](bool with_other) {
    Stack stack = make_stack(materials, make_box(Vec3::Constant(0.5)), 0.5, 3, {.quick_step = true});
    Stack other = make_stack(materials, make_box(Vec3::Constant(0.5)), 0.5, 4, {.quick_step = true});
    for (int i = 0; i < 100; ++i) {
      stack.world->step(1.0 / 60);
      if (with_other) other.world->step(1.0 / 60);
    }
    return stack.world->state(stack.bodies.back());
  };
  EXPECT_TRUE(same_bits(run(false), run(true)));
}

TEST(OdePairs, StaleIdsOfReusedSlotsAreRefused) {
  const MaterialTable materials;
  OdeWorld world({}, materials);
  const auto shape = box_shape({1, 1, 1});
  const OdeBodyId first = world.add_body({.shape = shape});
  world.remove_body(first);
  const OdeBodyId second = world.add_body({.shape = shape});
  EXPECT_NE(first, second);
  EXPECT_THROW(world.state(first), InputError);
  EXPECT_EQ(world.counters().trimeshes_built, 1);
  EXPECT_EQ(world.counters().bodies_created, 2);
}

}  // namespace
}  // namespace lodestone
