// A step of an OdeWorld, against laws and against plain ODE.
#include <gtest/gtest.h>
#include <ode/ode.h>

#include "reference/random.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

// A lone body in free flight: to the bit what plain ODE makes of it, whatever its spin.
TEST(WorldStep, FreeFlightIsPlainOdes) {
  RandomStream random(3, 0, 0);
  const auto box = box_shape({0.2, 0.3, 0.5});
  for (int i = 0; i < 5; ++i) {
    const RigidState start =
        at({1, 2, 3}, random.direction(), 5.0 * random.direction(), random.orientation());
    const MaterialTable materials;
    OdeWorld world({}, materials);
    const OdeBodyId ours = world.add_body({.shape = box, .mass = 2.0, .state = start});
    const dWorldID plain = dWorldCreate();
    dWorldSetGravity(plain, 0, 0, -kGravity);
    const dBodyID body = dBodyCreate(plain);
    dMass mass;
    const Mat3 inertia = 2.0 * box->inertia_per_mass;
    dMassSetParameters(&mass, 2.0, 0, 0, 0, inertia(0, 0), inertia(1, 1), inertia(2, 2), inertia(0, 1),
                       inertia(0, 2), inertia(1, 2));
    dBodySetMass(body, &mass);
    dBodySetPosition(body, 1, 2, 3);
    const dQuaternion q = {start.orientation.w(), start.orientation.x(), start.orientation.y(),
                           start.orientation.z()};
    dBodySetQuaternion(body, q);
    dBodySetLinearVel(body, start.velocity.x(), start.velocity.y(), start.velocity.z());
    dBodySetAngularVel(body, start.angular_velocity.x(), start.angular_velocity.y(),
                       start.angular_velocity.z());
    for (int step = 0; step < 50; ++step) {
      world.step(1.0 / 60, 4);
      for (int k = 0; k < 4; ++k) dWorldStep(plain, 1.0 / 240);
    }
    const RigidState now = world.state(ours);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(now.position[axis], dBodyGetPosition(body)[axis], 1e-12);
      EXPECT_NEAR(now.velocity[axis], dBodyGetLinearVel(body)[axis], 1e-12);
      EXPECT_NEAR(now.angular_velocity[axis], dBodyGetAngularVel(body)[axis], 1e-9);
    }
    dWorldDestroy(plain);
  }
}

// Substeps are steps.
TEST(WorldStep, SubstepsAreAsManySteps) {
  const MaterialTable materials = material(0.3, 0.5);
  OdeWorld one({}, materials), many({}, materials);
  std::vector<OdeBodyId> bodies;
  for (OdeWorld* world : {&one, &many}) {
    world->add_plane(Vec3::UnitZ(), 0.0, 0);
    for (int i = 0; i < 4; ++i)
      bodies.push_back(
          world->add_body({.shape = box_shape({0.2, 0.2, 0.2}),
                           .state = at({0.05 * i, 0, 0.15 + 0.21 * i}, {0, 0, 0}, {1, 0, i + 0.0})}));
  }
  for (int step = 0; step < 30; ++step) {
    one.step(0.02, 4);
    for (int k = 0; k < 4; ++k) many.step(0.005, 1);
  }
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_TRUE(same_bits(one.state(bodies[i]), many.state(bodies[4 + i]))) << i;
}

// Turned about the vertical, mirrored or moved sideways, a heap falls as before.
TEST(WorldStep, HasNoPreferredDirection) {
  const auto run_turned = [](const Quat& turn, const Vec3& away) {
    const MaterialTable materials = material(0.4, 0.5);
    OdeWorld world({}, materials);
    world.add_plane(Vec3::UnitZ(), 0.0, 0);
    const auto box = box_shape({0.2, 0.3, 0.4});
    const OdeBodyId body = world.add_body(
        {.shape = box,
         .state = at(turn * Vec3(0.3, -0.2, 0.6) + away, turn * Vec3(1, 0.5, -1), turn * Vec3(2, -3, 1),
                     turn * Quat(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized())))});
    for (int i = 0; i < 120; ++i) world.step(1.0 / 240, 1);
    RigidState state = world.state(body);
    state.position = turn.conjugate() * (state.position - away);
    state.velocity = turn.conjugate() * state.velocity;
    return state;
  };
  const RigidState plain = run_turned(Quat::Identity(), Vec3::Zero());
  for (const double angle : {0.5, 2.0}) {
    const RigidState turned = run_turned(Quat(Eigen::AngleAxisd(angle, Vec3::UnitZ())), Vec3(3, -7, 0));
    EXPECT_LT((turned.position - plain.position).norm(), 1e-6) << angle;
    EXPECT_LT((turned.velocity - plain.velocity).norm(), 1e-5) << angle;
  }
}

// What two bodies give each other they take from each other: in a heap in space momentum is kept.
TEST(WorldStep, KeepsMomentumAndNeverGainsEnergyBetweenBodies) {
  RandomStream random(4, 0, 0);
  const MaterialTable materials = material(0.5, 0.4);
  OdeWorld world({.gravity = Vec3::Zero()}, materials);
  const auto box = box_shape({0.3, 0.3, 0.3});
  std::vector<OdeBodyId> bodies;
  std::vector<double> masses;
  for (int i = 0; i < 8; ++i) {
    const Vec3 place = 1.2 * random.direction();
    masses.push_back(random.uniform(1.0, 5.0));
    bodies.push_back(
        world.add_body({.shape = box,
                        .mass = masses.back(),
                        .state = at(place, -place, 2.0 * random.direction(), random.orientation())}));
  }
  const auto sums = [&] {
    Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
    double energy = 0.0;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const RigidState s = world.state(bodies[i]);
      const Vec3 spin =
          s.orientation * (box->inertia_per_mass * (s.orientation.conjugate() * s.angular_velocity));
      linear += masses[i] * s.velocity;
      angular += masses[i] * (s.position.cross(s.velocity) + spin);
      energy += 0.5 * masses[i] * (s.velocity.squaredNorm() + s.angular_velocity.dot(spin));
    }
    return std::tuple(linear, angular, energy);
  };
  const auto [linear, angular, energy] = sums();
  double last = energy;
  for (int i = 0; i < 240; ++i) {
    world.step(1.0 / 240);
    const auto [l, a, e] = sums();
    EXPECT_LT((l - linear).norm(), 1e-9);
    EXPECT_LE(e, last * 1.02 + 1e-9);
    last = e;
  }
  EXPECT_LT((std::get<1>(sums()) - angular).norm(), 0.05 * angular.norm() + 0.05);
  EXPECT_LT(last, 0.9 * energy);  // they met
}

// Worlds know nothing of each other, in whatever order they are stepped.
TEST(WorldStep, WorldsAreIndependent) {
  const MaterialTable materials = material(0.4, 0.5);
  const auto make = [&](OdeWorld& world) {
    world.add_plane(Vec3::UnitZ(), 0.0, 0);
    return world.add_body(
        {.shape = box_shape({0.2, 0.2, 0.3}), .state = at({0, 0, 0.4}, {1, 0, 0}, {3, 2, 1})});
  };
  OdeWorld alone({}, materials), beside({}, materials), other({}, materials);
  const OdeBodyId a = make(alone), b = make(beside);
  make(other);
  for (int i = 0; i < 60; ++i) alone.step(1.0 / 60, 4);
  for (int i = 0; i < 60; ++i) other.step(1.0 / 90, 3), beside.step(1.0 / 60, 4);
  EXPECT_TRUE(same_bits(alone.state(a), beside.state(b)));
}

// Coulomb's cone: the momentum that friction takes in sliding is no more than μ times what the normal gives.
TEST(WorldStep, FrictionTakesAtMostItsShareOfTheNormal) {
  for (const double mu : {0.0, 0.2, 0.7}) {
    const MaterialTable materials = material(0.0, mu);
    OdeWorld world({}, materials);
    world.add_plane(Vec3::UnitZ(), 0.0, 0);
    const OdeBodyId slab = world.add_body(
        {.shape = box_shape({0.6, 0.6, 0.05}), .mass = 3.0, .state = at({0, 0, 0.025}, {4, 3, 0})});
    for (int i = 0; i < 96; ++i) world.step(1.0 / 480);
    const double expected = std::max(0.0, 5.0 - mu * kGravity * 0.2);
    EXPECT_NEAR(world.state(slab).velocity.head<2>().norm(), expected, 0.03);
    EXPECT_NEAR(world.state(slab).velocity.y() / world.state(slab).velocity.x(), 0.75, 0.01);
  }
}

// Where all sleep a step does nothing, not even gravity; who was put there sleeps on.
TEST(WorldStep, SleepersCostNothing) {
  const MaterialTable materials;
  OdeWorld world({.auto_disable = true}, materials);
  const OdeBodyId body = world.add_body({.shape = box_shape({0.2, 0.2, 0.2}), .state = at({0, 0, 5})});
  world.set_asleep(body, true);
  const RigidState before = world.state(body);
  for (int i = 0; i < 10; ++i) world.step(1.0 / 60);
  EXPECT_TRUE(same_bits(world.state(body), before));
  world.set_asleep(body, false);
  world.step(1.0 / 60);
  EXPECT_LT(world.state(body).velocity.z(), 0.0);
}

}  // namespace
}  // namespace lodestone
