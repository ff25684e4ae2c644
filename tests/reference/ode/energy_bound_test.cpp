#include <gtest/gtest.h>
#include <ode/ode.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "reference/ode/energy_bound_ode.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone::ode {
namespace {

using namespace testing;

constexpr double kStep = 1.0 / 240;  // s

/// A light cube on a heavy one, in contact, a caller's forces on both.
struct TwoCubes {
  TwoCubes() {
    for (const double mass : {1.0, 50.0})
      ids.push_back(bodies.add(world,
                               {.shape = cube, .mass = mass, .state = at({0, 0, 0.2 * double(ids.size())})},
                               OdeSettings{}, cache));
  }
  ~TwoCubes() {
    bodies.clear();
    dSpaceDestroy(space), dWorldDestroy(world);
  }
  void note(double depth = 0.0, int contacts = 1) {
    const std::vector<OdeContact> all(
        std::size_t(contacts),
        {.first = ids[1], .second = ids[0], .point = {0, 0, 0.1}, .normal = Vec3::UnitZ(), .depth = depth});
    bound.begin(bodies);
    bound.note(bodies, all, Vec3(0, 0, -kGravity), {.per_depth = 50.0, .most = 1.0}, kStep);
  }
  Body& light() { return bodies.find(ids[0]); }
  Body& heavy() { return bodies.find(ids[1]); }
  void set_velocities(const Vec3& of_light, const Vec3& of_heavy) {
    dBodySetLinearVel(light().body, of_light.x(), of_light.y(), of_light.z());
    dBodySetLinearVel(heavy().body, of_heavy.x(), of_heavy.y(), of_heavy.z());
  }
  double kinetic() {
    return 0.5 * (light().mass() * state_of(light().body).velocity.squaredNorm() +
                  heavy().mass() * state_of(heavy().body).velocity.squaredNorm());
  }

  std::shared_ptr<const Shape> cube = box_shape({0.2, 0.2, 0.2});
  dWorldID world = dWorldCreate();
  dSpaceID space = dHashSpaceCreate(nullptr);
  TrimeshCache cache;
  Bodies bodies{space};
  std::vector<OdeBodyId> ids;
  EnergyBound bound;
};

TEST(EnergyBound, AForceGivesWhatItMovesItsBodyBy) {
  TwoCubes cubes;
  dBodyAddForce(cubes.light().body, 0, 0, -20000);  // 83 m/s a step, were nothing below it
  cubes.note();
  EXPECT_TRUE(cubes.bound.is_kept(cubes.bodies));
  cubes.set_velocities({15, 0, 0}, {0, 0, 0});  // nowhere that it is pushed to
  EXPECT_FALSE(cubes.bound.is_kept(cubes.bodies));
  cubes.set_velocities({0, 0, -15}, {0, 0, 0});
  EXPECT_TRUE(cubes.bound.is_kept(cubes.bodies));
}

TEST(EnergyBound, WhoHasMoreIsSlowedDownWithItsMomentum) {
  TwoCubes cubes;
  cubes.set_velocities({1, 0, 0}, {1, 0, 0});
  cubes.note();
  const double before = cubes.kinetic();
  cubes.set_velocities({-49, 0, 30}, {2, 0, -0.6});  // the same momentum
  ASSERT_FALSE(cubes.bound.is_kept(cubes.bodies));
  cubes.bound.keep(cubes.bodies);
  EXPECT_TRUE(cubes.bound.is_kept(cubes.bodies));
  EXPECT_LT(cubes.kinetic(), 1.01 * before);
  const RigidState light = state_of(cubes.light().body), heavy = state_of(cubes.heavy().body);
  EXPECT_LT((light.velocity + 50.0 * heavy.velocity - Vec3(51, 0, 0)).norm(), 1e-9);
  EXPECT_LT((light.position - kStep * light.velocity).norm(), 1e-9);  // from where it was
}

// Two that overlap by 10 cm are pushed apart at 1 m/s at most, in however many points they touch.
TEST(EnergyBound, AnOverlapGivesWhatItIsPushedApartBy) {
  for (const int contacts : {1, 4, 16}) {
    TwoCubes cubes;
    cubes.note(0.1, contacts);
    cubes.set_velocities({0, 0, -1.0}, {0, 0, 0.02});
    EXPECT_TRUE(cubes.bound.is_kept(cubes.bodies)) << contacts;
    cubes.set_velocities({0, 0, -5.0}, {0, 0, 1.5});
    EXPECT_FALSE(cubes.bound.is_kept(cubes.bodies)) << contacts;
  }
}

TEST(EnergyBound, WhatIsNoNumberIsPutBack) {
  TwoCubes cubes;
  cubes.note();
  cubes.set_velocities(Vec3::Constant(std::numeric_limits<double>::quiet_NaN()), {0, 0, 0});
  cubes.bound.keep(cubes.bodies);
  for (const OdeBodyId id : cubes.ids) EXPECT_TRUE(is_sound(state_of(cubes.bodies.find(id).body)));
}

// A wall that is put 10 to 20 cm into a crate that lies alone on a plane: ODE shot it off at up to 119 m/s.
TEST(EnergyBound, OfWhatStandsStillOnBothSidesOfABodyNoneThrowsItFar) {
  const MaterialTable materials;
  for (const double x : {0.25, 0.3, 0.35, 0.4})
    for (const double z : {0.1, 0.15, 0.2}) {
      OdeWorld world(OdeSettings{}, materials);
      world.add_plane(Vec3::UnitZ(), 0.0, 0);
      const OdeBodyId crate =
          world.add_body({.shape = box_shape({0.4, 0.3, 0.2}), .mass = 24.0, .state = at({0, 0, 0.1})});
      for (int i = 0; i < 20; ++i) world.step(1.0 / 60.0, 4);
      world.add_static_box({0.6, 0.6, 0.3}, {x, 0.05, z}, Quat::Identity(), 0);
      double fastest = 0.0;  // m/s
      for (int i = 0; i < 30; ++i) {
        world.step(1.0 / 60.0, 4);
        fastest = std::max(fastest, world.state(crate).velocity.norm());
      }
      EXPECT_LT(fastest, 12.0) << x << ' ' << z;
    }
}

}  // namespace
}  // namespace lodestone::ode
