// Trouble at the full level, as the step report tells it.
#include <gtest/gtest.h>
#include <ode/ode.h>

#include <algorithm>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone::full_level_report_test {
namespace {

using namespace testing;

void complain(dBodyID) { dMessage(1, "as ODE would say it"); }

TEST(FullLevelReport, CountsOdesMessagesAndPrintsNone) {
  Manager manager(unmeasured());
  const BodyId body = add(manager, box_shape({0.2, 0.2, 0.2}), at({0, 0, 1}), LevelChoice::full);
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(manager.step(kFrame).counters.ode_messages, 0);
  dBodySetMovedCallback(manager.ode_body(body), complain);  // within each of the steps
  const std::int64_t first = manager.step(kFrame).counters.ode_messages;
  EXPECT_GE(first, ManagerSettings{}.full_substeps);
  EXPECT_EQ(manager.step(kFrame).counters.ode_messages, 2 * first);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST(FullLevelReport, BodiesPlacedInEachOtherPartAtTheCorrectingVelocity) {
  Manager manager({.gravity = Vec3::Zero(), .policy = {}, .signatures = no_signature});
  const auto cube = box_shape({1, 1, 1});
  const BodyId first = add(manager, cube, at({0, 0, 0}), LevelChoice::full),
               second = add(manager, cube, at({0.5, 0.01, 0.02}), LevelChoice::full);
  double greatest = 0.0;
  for (int i = 0; i < 60; ++i) {
    manager.step(kFrame);
    greatest = std::max(greatest, (manager.state(first).velocity - manager.state(second).velocity).norm());
  }
  EXPECT_NEAR(greatest, 1.0, 0.02);
  EXPECT_GT((manager.state(first).position - manager.state(second).position).norm(), 0.99);
}

TEST(FullLevelReport, CountsPassesPrevented) {
  Manager manager({.gravity = Vec3::Zero(), .policy = {}, .signatures = no_signature});
  manager.add_static_box({0.05, 4, 4}, {1, 0, 0}, Quat::Identity());
  const BodyId ball = add(manager, sphere_shape(0.1), at({-2, 0, 0}, {200, 0, 0}), LevelChoice::full);
  run(manager, 0.1);
  EXPECT_EQ(manager.report().counters.full_passes_prevented, 1);
  EXPECT_LT(manager.state(ball).velocity.x(), 0.0);
}

// A floor of 64 cubes is more than dWorldStep is given, and QuickStep does not carry the giant on it.
TEST(FullLevelReport, CountsUnevenContactsInALargePile) {
  Manager manager = on_floor();
  const auto cube = box_shape({0.2, 0.2, 0.2});
  for (int i = 0; i < 64; ++i)
    manager.add_body(
        {.shape = cube, .state = at({0.2 * (i % 8), 0.2 * (i / 8), 0.0999}), .level = LevelChoice::full});
  const BodyId giant = manager.add_body({.shape = box_shape({1.6, 1.6, 0.2}),
                                         .state = at({0.7, 0.7, 0.2997}),
                                         .mass = 1e5,
                                         .level = LevelChoice::full});
  run(manager, 0.1);
  EXPECT_GT(manager.report().counters.full_quick_steps, 0);
  EXPECT_GT(manager.report().counters.full_uneven_contacts, 0);
  EXPECT_TRUE(manager.valid(giant));
}

}  // namespace
}  // namespace lodestone::full_level_report_test
