// Category and collide bits of the caller's own geoms hold towards bodies of every rung, as in dSpaceCollide.
#include <gtest/gtest.h>
#include <ode/ode.h>

#include <string>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

constexpr double kCrateSide = 0.4;  // m, of the crate

class CallersBits : public ::testing::TestWithParam<LevelChoice> {
 protected:
  CallersBits() { dWorldSetGravity(world_, 0, 0, -9.81); }
  ~CallersBits() override {
    dSpaceDestroy(space_);
    dWorldDestroy(world_);
  }
  // With its top at z = 0.
  dGeomID add_ground(const std::string& kind) const {
    if (kind == "plane") return dCreatePlane(space_, 0, 0, 1, 0);
    const dGeomID box = dCreateBox(space_, 4, 4, 0.2);
    if (kind == "box") return dGeomSetPosition(box, 0, 0, -0.1), box;
    const dBodyID body = dBodyCreate(world_);
    dMass mass;
    dMassSetBoxTotal(&mass, 1000, 4, 4, 0.2);
    dBodySetMass(body, &mass);
    dGeomSetBody(box, body);
    dBodySetPosition(body, 0, 0, -0.1);
    dBodySetGravityMode(body, 0);
    if (kind == "kinematic body") dBodySetKinematic(body);
    return box;
  }
  static void set_bits(dGeomID geom, unsigned category, unsigned collide) {
    dGeomSetCategoryBits(geom, category), dGeomSetCollideBits(geom, collide);
  }
  BodyId add_crate(Manager& manager, const BodyProperties& properties) const {
    return manager.add_body({.shape = box_shape({kCrateSide, kCrateSide, kCrateSide}),
                             .state = testing::at({0, 0, 0.5 * kCrateSide + 0.1}),
                             .mass = 10.0,
                             .level = GetParam(),
                             .properties = properties});
  }
  dWorldID world_ = dWorldCreate();
  dSpaceID space_ = dHashSpaceCreate(nullptr);
};

TEST_P(CallersBits, LetThroughWhomTheyDoNotMeet) {
  for (const char* kind : {"plane", "box", "body", "kinematic body"}) {
    const dGeomID ground = add_ground(kind);
    set_bits(ground, 2, 2);
    {
      Manager manager(world_, space_, {.signatures = coarse_signature});
      const BodyId through = add_crate(manager, {.category = 1, .collide = 1});
      run(manager, 1.0);
      EXPECT_LT(manager.state(through).position.z(), -3.0) << kind;
      manager.remove_body(through);
      for (const BodyProperties& meets : {BodyProperties{}, BodyProperties{.category = 2, .collide = 1},
                                          BodyProperties{.category = 1, .collide = 2}}) {
        const BodyId body = add_crate(manager, meets);
        run(manager, 0.5);
        EXPECT_GT(manager.state(body).position.z(), 0.0) << kind;  // a body gives way
        manager.remove_body(body);
      }
    }
    if (dBodyID body = dGeomGetBody(ground)) dBodyDestroy(body);
    dGeomDestroy(ground);
  }
}

TEST_P(CallersBits, HoldFromWhenTheyAreSet) {
  const dGeomID ground = add_ground("box");
  Manager manager(world_, space_, {.signatures = coarse_signature});
  const BodyId crate = add_crate(manager, {.category = 1, .collide = 1});
  run(manager, 1.0);
  EXPECT_NEAR(manager.state(crate).position.z(), 0.5 * kCrateSide, 2e-3);
  set_bits(ground, 2, 2);
  manager.wake(crate);
  run(manager, 1.0);
  EXPECT_LT(manager.state(crate).position.z(), -3.0);
}

INSTANTIATE_TEST_SUITE_P(Rungs, CallersBits,
                         ::testing::Values(LevelChoice::full, LevelChoice::support, LevelChoice::tables),
                         [](const auto& level) {
                           return level.param == LevelChoice::full      ? "Full"
                                  : level.param == LevelChoice::support ? "Support"
                                                                        : "Tables";
                         });

}  // namespace
}  // namespace lodestone
