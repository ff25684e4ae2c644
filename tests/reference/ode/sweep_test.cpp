// Fast bodies: none passes through what it would have met (hard case F13), and slow ones go unhindered.
#include <gtest/gtest.h>
#include <ode/ode.h>

#include "reference/random.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

constexpr double kStep = 1.0 / 60;
const Vec3 kFast(200, 0, 0);

// A wall of five centimetres across the x axis.
void add_wall(OdeWorld& world, const Vec3& place) {
  world.add_static_box({0.05, 4, 4}, place, Quat::Identity(), 0);
}

TEST(Sweep, BallBouncesOffAThinWallWithItsWholeSpeed) {
  const MaterialTable materials = material(1.0, 0.0);
  OdeWorld world({.gravity = Vec3::Zero()}, materials);
  add_wall(world, {1.0, 0, 0});
  const OdeBodyId ball = world.add_body({.shape = sphere_shape(0.1), .state = at({-1, 0, 0}, kFast)});
  for (int i = 0; i < 3; ++i) world.step(kStep);
  EXPECT_NEAR(world.state(ball).velocity.x(), -200.0, 1e-3);
  EXPECT_EQ(world.counters().passes_prevented, 1);
}

TEST(Sweep, StopsWhereTheBodyTouches) {
  const MaterialTable materials = material(1.0, 0.0);
  OdeWorld world({.gravity = Vec3::Zero()}, materials);
  add_wall(world, {1.0, 0, 0});
  const OdeBodyId ball = world.add_body({.shape = sphere_shape(0.1), .state = at({-1, 0, 0}, kFast)});
  world.step(kStep);
  EXPECT_NEAR(world.state(ball).position.x(), 0.975 - 0.09, 1e-12);
  EXPECT_EQ(world.state(ball).velocity, kFast);
}

// Slower than they are thick, they turn about the corner that struck: what comes out behind the wall turns
// them back.
TEST(Sweep, CubesDoNotTurnThroughAWallThinnerThanThey) {
  const MaterialTable materials = material(0.2, 0.5);
  for (const int substeps : {4, 8, 16})
    for (const double speed : {10.0, 20.0, 40.0, 60.0}) {
      OdeWorld world({.gravity = Vec3::Zero(), .max_correcting_velocity = 1.0}, materials);
      world.add_static_box({0.02, 30, 4}, Vec3::Zero(), Quat::Identity(), 0);
      std::vector<OdeBodyId> cubes;
      for (std::uint32_t i = 0; i < 40; ++i) {
        RandomStream random(7, i, 0);
        const Vec3 place(-0.5 - 0.2 * random.uniform(), 0.7 * (i - 19.5), 0);
        cubes.push_back(world.add_body(
            {.shape = box_shape(Vec3::Constant(0.12)),
             .mass = 2.0,
             .state = at(place, {speed, 0, 0}, 8.0 * random.direction(), random.orientation())}));
      }
      for (int i = 0; i < 20; ++i) world.step(kStep, substeps);
      for (const OdeBodyId cube : cubes)
        EXPECT_LT(world.state(cube).position.x(), 0.0) << substeps << " substeps, " << speed << " m/s";
    }
}

TEST(Sweep, IsAsPreciseFarFromTheOrigin) {
  const MaterialTable materials = material(1.0, 0.0);
  OdeWorld world({.gravity = Vec3::Zero()}, materials);
  const Vec3 far = Vec3::Constant(1e7);
  world.add_body({.shape = box_shape({0.05, 4, 4}), .mass = 1e6, .state = at(far + Vec3(1, 0, 0))});
  const OdeBodyId ball =
      world.add_body({.shape = sphere_shape(0.1), .state = at(far - Vec3(1, 0, 0), kFast)});
  world.step(kStep);
  EXPECT_NEAR(world.state(ball).position.x() - far.x(), 0.975 - 0.09, 1e-6);
}

TEST(Sweep, LooksRelativeToWhatMovesAlong) {
  const MaterialTable materials;
  OdeWorld world({.gravity = Vec3::Zero()}, materials);
  const OdeBodyId behind = world.add_body({.shape = sphere_shape(0.1), .state = at({0, 0, 0}, kFast)});
  world.add_body({.shape = sphere_shape(0.1), .state = at({0.5, 0, 0}, kFast)});
  for (int i = 0; i < 10; ++i) world.step(kStep);
  EXPECT_EQ(world.counters().passes_prevented, 0);
  EXPECT_NEAR(world.state(behind).position.x(), 200.0 / 6, 1e-9);
}

TEST(Sweep, LeavesBodiesAloneThatMoveLessThanTheirThickness) {
  const MaterialTable materials = material(0.3, 0.5);
  OdeWorld world({}, materials);
  world.add_plane(Vec3::UnitZ(), 0.0, 0);
  add_wall(world, {1.0, 0, 0});
  for (int i = 0; i < 5; ++i)
    world.add_body({.shape = box_shape(Vec3::Constant(0.2)),
                    .mass = 8.0,
                    .state = at({0, 0, 0.2 + 0.3 * i}, {3, 0, 0})});
  for (int i = 0; i < 300; ++i) world.step(1.0 / 240);
  EXPECT_EQ(world.counters().passes_prevented, 0);
}

// Many small bodies faster than they are thick, in all directions: each pair is looked at as if alone.
TEST(Sweep, NoneOfACrowdPassesThroughTheWallsOfABox) {
  const MaterialTable materials = material(1.0, 0.0);
  OdeWorld world({.gravity = Vec3::Zero()}, materials);
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0})
      world.add_static_box(Vec3::Constant(4.2) - 4.15 * Vec3::Unit(axis), 2.1 * side * Vec3::Unit(axis),
                           Quat::Identity(), 0);
  std::vector<OdeBodyId> balls;
  for (std::uint32_t i = 0; i < 100; ++i) {
    RandomStream random(3, i, 0);
    const Vec3 place(0.6 * (i % 5) - 1.2, 0.6 * (i / 5 % 5) - 1.2, 0.6 * (i / 25) - 0.9);
    balls.push_back(
        world.add_body({.shape = sphere_shape(0.05), .state = at(place, 100.0 * random.direction())}));
  }
  for (int i = 0; i < 60; ++i) world.step(kStep);
  for (const OdeBodyId ball : balls) EXPECT_LT(world.state(ball).position.lpNorm<Eigen::Infinity>(), 2.1);
  EXPECT_GT(world.counters().passes_prevented, 1000);
}

TEST(Sweep, LeavesJointedBodiesToTheirJoint) {
  const MaterialTable materials;
  OdeWorld world({.gravity = Vec3::Zero()}, materials);
  add_wall(world, {1.0, 0, 0});
  const OdeBodyId ball = world.add_body({.shape = sphere_shape(0.1), .state = at({-1, 0, 0}, kFast)});
  const dJointID slider = dJointCreateSlider(world.ode_world(), nullptr);
  dJointAttach(slider, world.ode_body(ball), nullptr);
  dJointSetSliderAxis(slider, 1, 0, 0);
  world.step(kStep);
  EXPECT_EQ(world.counters().passes_prevented, 0);
  EXPECT_GT(world.state(ball).position.x(), 2.0);
  dJointDestroy(slider);
}

TEST(Sweep, SeesTheCallersStaticGeoms) {
  const MaterialTable materials;
  const dWorldID world = dWorldCreate();
  const dSpaceID space = dHashSpaceCreate(nullptr), inner = dSimpleSpaceCreate(space);
  const dGeomID wall = dCreateBox(inner, 0.05, 4, 4), sensor = dCreateBox(inner, 0.05, 4, 4);
  dGeomSetPosition(wall, 1.0, 0, 0);
  dGeomSetPosition(sensor, -0.5, 0, 0);
  dGeomSetCategoryBits(sensor, 0);
  dGeomSetCollideBits(sensor, 0);
  {
    OdeWorld ours(world, space, {}, materials);
    const OdeBodyId ball = ours.add_body({.shape = sphere_shape(0.1), .state = at({-1, 0, 0}, kFast)});
    ours.step(kStep);
    EXPECT_NEAR(ours.state(ball).position.x(), 0.975 - 0.09, 1e-12);
  }
  dSpaceDestroy(space);
  dWorldDestroy(world);
}

// Thrown at a wall, of a box or of a mesh, they reach into it, strike it with a corner and are turned: some
// have the start of a ray in it on their way back. None stays where it is while its speed grows.
TEST(Sweep, NobodyHangsOnAWallThatItBouncesOff) {
  const MaterialTable materials = material(0.3, 0.5);
  for (const bool of_mesh : {false, true}) {
    OdeWorld world({}, materials);
    const Vec3 sides(0.2, 400, 60);
    if (of_mesh)
      world.add_static_mesh(make_box(sides), 0);
    else
      world.add_static_box(sides, Vec3::Zero(), Quat::Identity(), 0);
    struct Thrown {
      OdeBodyId body;
      Vec3 place = Vec3::Zero();
      int still = 0;
    };
    std::vector<Thrown> thrown;
    for (std::uint32_t i = 0; i < 300; ++i) {
      RandomStream random(11, i, 0);
      const Vec3 from(-2, i - 150.0, 2.0 * random.uniform()), spin = 8.0 * random.direction();
      const Vec3 velocity(10.0 + 20.0 * random.uniform(), 4.0 * random.uniform() - 2.0,
                          3.0 * random.uniform());
      thrown.push_back({world.add_body({.shape = box_shape({0.1, 0.075, 0.05}),
                                        .mass = 0.375,
                                        .state = at(from, velocity, spin, random.orientation())})});
    }
    for (int step = 0; step < 60; ++step) {
      world.step(kStep, 4);
      for (auto& [body, place, still] : thrown) {
        const RigidState now = world.state(body);
        still = (now.position - place).norm() < 1e-4 && now.velocity.norm() > 0.5 ? still + 1 : 0;
        place = now.position;
        EXPECT_LT(still, 12) << of_mesh;
        EXPECT_LT(place.x(), 0.1) << of_mesh;
      }
    }
  }
}

TEST(Sweep, HollowsLetGo) {
  // The bar enters the corner of an L, where the L's centre of mass is in the air, and must not be held
  // there.
  const MaterialTable materials = material(0.0, 0.0);
  OdeWorld world({.gravity = Vec3::Zero()}, materials);
  const auto l = std::make_shared<const Shape>(make_shape("l", make_l(1.0, 1.0, 0.1, 0.1)));
  world.add_static_box({0.02, 0.02, 4.0}, {0, 0, 0}, Quat::Identity(), 0);
  const Vec3 way = Vec3(-1, -1, 0).normalized();  // with the open corner ahead
  const OdeBodyId body = world.add_body(
      {.shape = l,
       .mass = 1.0,
       .state = at(way * -3.0, 100.0 * way, Vec3::Zero(), Quat(Eigen::AngleAxisd(0.0, Vec3::UnitZ())))});
  for (int i = 0; i < 60; ++i) world.step(kStep);
  // Either it was struck or it is gone; it does not hang in the air with its speed.
  const RigidState end = world.state(body);
  EXPECT_TRUE(end.velocity.norm() < 99.0 || end.position.norm() > 10.0)
      << end.position.transpose() << " / " << end.velocity.transpose();
}

// Put into another body, with a corner out of it, it must not be held there while gravity goes on giving it
// speed.
TEST(Sweep, WhoIsInsideABodyMayLeaveIt) {
  const MaterialTable materials = material(0.2, 0.5);
  OdeWorld world({.gravity = Vec3(0, 0, -9.81)}, materials);
  world.add_static_box({4, 4, 0.2}, {0, 0, -0.1}, Quat::Identity(), 0);
  const auto cube = [](double side) {
    return std::make_shared<const Shape>(make_shape("cube", make_box({side, side, side})));
  };
  world.add_body({.shape = cube(0.4), .mass = 64.0, .state = at({0, 0, 0.2})});
  const OdeBodyId small =
      world.add_body({.shape = cube(0.05),
                      .mass = 0.125,
                      .state = at({-0.186, -0.123, 0.23}, Vec3(-4.6, 7.9, -13.0), Vec3(20, 20, 10))});
  for (int i = 0; i < 480; ++i) world.step(kStep);
  const RigidState end = world.state(small);
  EXPECT_LT(end.velocity.norm(), 1.0);
  EXPECT_GT((end.position - Vec3(0, 0, 0.2)).cwiseAbs().maxCoeff(), 0.22);
}

TEST(OdeWorld, QuickStepCountsUnevenContacts) {
  const MaterialTable materials = material(0.0, 0.5);
  for (const bool quick : {false, true})
    for (const double ratio : {10.0, 1000.0}) {
      OdeWorld world({.quick_step = quick}, materials);
      world.add_plane(Vec3::UnitZ(), 0.0, 0);
      world.add_body({.shape = box_shape(Vec3::Constant(0.2)), .mass = 1.0, .state = at({0, 0, 0.0999})});
      world.add_body({.shape = box_shape(Vec3::Constant(0.2)), .mass = ratio, .state = at({0, 0, 0.2998})});
      world.step(1.0 / 240);
      EXPECT_EQ(world.counters().uneven_contacts > 0, quick && ratio > 100.0) << quick << ' ' << ratio;
    }
}

TEST(OdeWorld, BoxPrimitiveStacksAndBouncesAsItsShape) {
  const MaterialTable materials = material(0.5, 0.3);
  OdeWorld world({}, materials);
  world.add_plane(Vec3::UnitZ(), 0.0, 0);
  const OdeBodyId box = world.add_body(
      {.shape = box_shape({0.3, 0.2, 0.1}), .state = at({0, 0, 1.05}), .geometry = OdeGeometry::box});
  double top = 0.0;
  bool falling = true;
  for (int i = 0; i < 1500; ++i) {
    world.step(5e-4);
    falling = falling && world.state(box).velocity.z() <= 0.0;
    if (!falling) top = std::max(top, world.state(box).position.z());
  }
  EXPECT_NEAR(top - 0.05, 0.25, 0.005);
  EXPECT_EQ(world.counters().trimeshes_built, 0);
}

TEST(OdeWorldDeathTest, BoxPrimitiveNeedsItsCentreOfMassInTheMiddle) {
  const MaterialTable materials;
  OdeWorld world({}, materials);
  const auto loaded = std::make_shared<const Shape>(
      make_shape("loaded", make_box({1, 1, 1}), {.center_of_mass_m = Vec3(0, 0, 0.2)}));
  EXPECT_DEATH(world.add_body({.shape = loaded, .geometry = OdeGeometry::box}), "in its middle");
}

}  // namespace
}  // namespace lodestone
