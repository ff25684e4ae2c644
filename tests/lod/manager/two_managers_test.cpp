// Several managers in one world of a caller's.
#include <gtest/gtest.h>
#include <ode/ode.h>

#include <memory>

#include "tests/lod/callers/callers_scene.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone::testing {
namespace {

class TwoManagers : public ::testing::Test {
 protected:
  TwoManagers() {
    dWorldSetGravity(scene_.world, 0, 0, -9.81);
    dCreatePlane(scene_.space, 0, 0, 1, 0);
  }
  /// With a row of tumbling boxes, each on a rung of its own, `y` m off.
  std::unique_ptr<Manager> make(double y, const std::shared_ptr<const Signature>& signature) {
    auto manager = std::make_unique<Manager>(
        scene_.world, scene_.space,
        ManagerSettings{.signatures = [signature](const Shape&, const ContactLaw&) { return signature; }});
    for (int i = 0; i < 9; ++i)
      add(*manager, box_, at({0.35 * i, y, 0.6 + 0.1 * i}, {0, 0, 0}, {1, 2, 3}),
          std::array{LevelChoice::full, LevelChoice::support, LevelChoice::tables}[std::size_t(i % 3)]);
    return manager;
  }
  void step(std::initializer_list<Manager*> managers) {
    for (Manager* const manager : managers) manager->before_world_step(kFrame);
    dWorldStep(scene_.world, kFrame);
    for (Manager* const manager : managers) manager->after_world_step();
  }
  CallersScene scene_;
  std::shared_ptr<const Shape> box_ = box_shape({0.2, 0.3, 0.4});
};

TEST_F(TwoManagers, AroundOneWorldStepEachDoesAsByItself) {
  const auto signature = coarse_signature(*box_, {});
  std::vector<std::uint64_t> alone[2];
  for (int k = 0; k < 2; ++k) {
    const auto manager = make(0.05 * k, signature);
    for (int i = 0; i < 120; ++i) step({manager.get()}), alone[k].push_back(manager->state_hash());
  }
  auto first = make(0.0, signature);
  const auto second = make(0.05, signature);  // they do not meet
  for (std::size_t i = 0; i < 120; ++i) {
    if (i < 60)
      step({first.get(), second.get()});
    else
      first.reset(), step({second.get()});
    if (first) {
      ASSERT_EQ(first->state_hash(), alone[0][i]) << i;
    }
    ASSERT_EQ(second->state_hash(), alone[1][i]) << i;
  }
}

TEST_F(TwoManagers, BothBearABodyOfTheCallers) {
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support}) {
    Manager first(scene_.world, scene_.space, unmeasured()), second(scene_.world, scene_.space, unmeasured());
    const auto cube = box_shape({0.4, 0.4, 0.4});
    add(first, cube, at({-1, 0, 0.2}), level), add(second, cube, at({1, 0, 0.2}), level);
    const dBodyID plank = scene_.body(100.0, {0, 0, 0.46});
    dMass mass;
    dMassSetBoxTotal(&mass, 100.0, 3.0, 0.5, 0.1);
    dBodySetMass(plank, &mass);
    dGeomBoxSetLengths(dBodyGetFirstGeom(plank), 3.0, 0.5, 0.1);
    for (int i = 0; i < 180; ++i) step({&first, &second});
    EXPECT_NEAR(dBodyGetPosition(plank)[2], 0.45, 0.005);
    dGeomDestroy(dBodyGetFirstGeom(plank)), dBodyDestroy(plank);
  }
}

}  // namespace
}  // namespace lodestone::testing
