// Hard case F15 within a run: bodies that no level can hold are put to rest and counted, and never reach ODE.
#include <gtest/gtest.h>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

TEST(Recovery, AStatisticalBodyThatFliesTooFarComesToRestAtTheLimit) {
  Manager manager(unmeasured());
  const BodyId body = add(manager, box_shape({0.2, 0.3, 0.4}), at({1e8 - 1e5, 5, 0}, {1e6, 0, 0}), LevelChoice::statistical);
  run(manager, 0.2);
  EXPECT_EQ(manager.state(body).position.x(), 1e8);
  EXPECT_EQ(manager.state(body).velocity.x(), 0.0);
  EXPECT_EQ(manager.report().counters.states_recovered, 1);
  manager.set_level(body, LevelChoice::full);
  run(manager, 0.2);
  EXPECT_EQ(manager.level(body), Level::full);
  EXPECT_EQ(manager.report().counters.states_recovered, 1);
}

TEST(Recovery, AForceBeyondAllBoundsStopsTheBodyAtEveryLevel) {
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::statistical}) {
    Manager manager(unmeasured());
    const BodyId pushed = add(manager, box_shape({0.2, 0.3, 0.4}), at({1, 2, 3}), level);
    const BodyId beside = add(manager, box_shape({0.2, 0.3, 0.4}), at({1.5, 2, 3}), level);
    manager.step(kFrame);
    manager.add_force(pushed, {1e300, 0, 0}, {0, 1e300, 0});
    manager.step(kFrame);
    EXPECT_EQ(manager.report().counters.states_recovered, level == LevelChoice::full ? ManagerSettings{}.full_substeps : 1);
    EXPECT_LT((manager.state(pushed).position - Vec3(1, 2, 3)).norm(), 0.1);
    EXPECT_LT((manager.state(beside).position - Vec3(1.5, 2, 3)).norm(), 0.1);
    EXPECT_TRUE(manager.state(pushed).orientation.coeffs().allFinite());
  }
}

TEST(Recovery, FastBodiesWithinTheLimitAreLeftAlone) {
  Manager manager(unmeasured());
  const BodyId body = add(manager, box_shape({0.2, 0.3, 0.4}), at({0, 0, 0}, {1e6, 0, 0}, {0, 0, 1e3}), LevelChoice::statistical);
  run(manager, 0.5);
  EXPECT_EQ(manager.report().counters.states_recovered, 0);
  EXPECT_NEAR(manager.state(body).velocity.x(), 1e6, 1e-6);
}

}  // namespace
}  // namespace lodestone
