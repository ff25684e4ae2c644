// A full body between one of the caller's and a statistical one: what stands behind it is as heavy as it is,
// and behind it only while it is there.
#include <gtest/gtest.h>
#include <ode/ode.h>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone::struck_through_full_test {
namespace {

using namespace testing;

constexpr double kSide = 0.3, kMass = 8.0, kFrame = 1.0 / 60;  // m, kg, s

struct EmptyWorld {
  EmptyWorld() { dInitODE2(0); }
  ~EmptyWorld() {
    dSpaceDestroy(space);
    dWorldDestroy(world);
  }
  dWorldID world = dWorldCreate();
  dSpaceID space = dHashSpaceCreate(nullptr);
};

// Cubes in a row, without gravity or friction: the last one strikes the middle one when that has just met the
// first.
struct Row {
  Row(double gap, bool first_is_callers) {
    manager.materials().replace(0, {.restitution = kRestitution, .friction = 0.0});
    middle = add({kSide + gap, 0, 0}, {-2, 0, 0}, LevelChoice::full);
    last = add({2.0 * kSide + gap + 0.075, 0, 0}, {-4, 0, 0}, LevelChoice::support);
    if (first_is_callers)
      add_callers({1, 0, 0});
    else
      first = add({0, 0, 0}, {1, 0, 0}, LevelChoice::full);
  }
  BodyId add(const Vec3& place, const Vec3& velocity, LevelChoice level) {
    return manager.add_body({.shape = box_shape({kSide, kSide, kSide}),
                             .state = at(place, velocity),
                             .mass = kMass,
                             .level = level});
  }
  void add_callers(const Vec3& velocity) {
    callers = dBodyCreate(theirs.world);
    dMass mass;
    dMassSetBoxTotal(&mass, kMass, kSide, kSide, kSide);
    dBodySetMass(callers, &mass);
    dBodySetLinearVel(callers, velocity.x(), velocity.y(), velocity.z());
    dGeomSetBody(dCreateBox(theirs.space, kSide, kSide, kSide), callers);
  }
  void step() {
    manager.before_world_step(kFrame);
    dWorldStep(theirs.world, kFrame);
    manager.after_world_step();
  }
  std::array<double, 3> speeds() const {
    return {callers ? dBodyGetLinearVel(callers)[0] : manager.state(first).velocity.x(),
            manager.state(middle).velocity.x(), manager.state(last).velocity.x()};
  }
  double momentum() const {  // m/s, over one mass
    const auto v = speeds();
    return v[0] + v[1] + v[2];
  }
  double energy() const {  // J
    const auto v = speeds();
    return 0.5 * kMass * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  }

  static constexpr double kRestitution = 0.9;
  EmptyWorld theirs;
  Manager manager{theirs.world, theirs.space, {.full_substeps = 1, .signatures = coarse_signature}};
  BodyId first, middle, last;
  dBodyID callers = nullptr;
};

class StruckThroughFull : public ::testing::TestWithParam<bool> {};

// The caller's was taken for a wall that goes on as fast as it did before: of 81 J became 419.
TEST_P(StruckThroughFull, AddsNoEnergy) {
  for (const double gap : {0.02, 0.03, 0.04, 0.045}) {
    Row row(gap, GetParam());
    const double energy = row.energy(), momentum = row.momentum(), last = row.speeds()[2];
    for (int frame = 0; frame < 30; ++frame) {
      row.step();
      EXPECT_LT(row.energy(), 1.001 * energy) << gap << ", " << frame;
      EXPECT_NEAR(row.momentum(), momentum, 1e-6) << gap << ", " << frame;
    }
    EXPECT_GT(row.speeds()[2], last + 1.0) << gap;  // it did strike
  }
}

INSTANTIATE_TEST_SUITE_P(OfCallers, StruckThroughFull, ::testing::Bool());

}  // namespace
}  // namespace lodestone::struck_through_full_test
