#include <gtest/gtest.h>

#include "lod/manager.h"

namespace lodestone {
namespace {

Manager over_a_table() {
  ManagerSettings settings;
  settings.signatures = [](const Shape&, const ContactLaw&) { return nullptr; };
  Manager manager(settings);
  manager.add_plane(Vec3::UnitZ(), 0.0);
  manager.add_static_box({2, 2, 0.1}, {0, 0, 1}, Quat::Identity());
  return manager;
}

BodyId add_crate(Manager& manager, const Vec3& position, LevelChoice level) {
  static const auto crate = std::make_shared<const Shape>(make_shape("crate", make_box({0.2, 0.2, 0.2})));
  RigidState state;
  state.position = position;
  return manager.add_body({.shape = crate, .state = state, .level = level});
}

// The statistical level knows planes only, so what nears other ground becomes full, without any viewpoint.
TEST(StaticGround, ABodyThatNearsAStaticBoxIsFullAndRestsOnIt) {
  Manager manager = over_a_table();
  const BodyId above = add_crate(manager, {0, 0, 3}, LevelChoice::automatic), beside = add_crate(manager, {4, 0, 3}, LevelChoice::automatic);
  manager.step(1.0 / 60.0);
  EXPECT_EQ(manager.level(above), Level::statistical);
  for (int i = 0; i < 180; ++i) manager.step(1.0 / 60.0);
  EXPECT_EQ(manager.level(above), Level::full);
  EXPECT_NEAR(manager.state(above).position.z(), 1.15, 0.01);
  EXPECT_NE(manager.why(above).find("static"), std::string::npos) << manager.why(above);
  EXPECT_EQ(manager.level(beside), Level::statistical);
  EXPECT_NEAR(manager.state(beside).position.z(), 0.1, 0.01);
}

TEST(StaticGround, ABodyForcedStatisticalPassesThroughABox) {
  Manager manager = over_a_table();
  const BodyId forced = add_crate(manager, {0, 0, 3}, LevelChoice::statistical);
  for (int i = 0; i < 180; ++i) manager.step(1.0 / 60.0);
  EXPECT_EQ(manager.level(forced), Level::statistical);
  EXPECT_NEAR(manager.state(forced).position.z(), 0.1, 0.01);
}

}  // namespace
}  // namespace lodestone
