#include "lod/manager/change_pause.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "reference/random.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone::change_pause_test {
namespace {

using namespace testing;

/// Steps until it is over, while the budget is kept and the viewpoints stay.
int rest_of(ChangePause& pause, double traveled = 0.0) {
  int steps = 0;
  for (; pause.holds(); ++steps) pause.note(false, traveled);
  return steps;
}

TEST(ChangePause, IsTwiceAsLongEachTimeAndForgetsByHalves) {
  ChangePause pause;
  EXPECT_FALSE(pause.holds());
  for (const int expected : {8, 16, 32, 64, 128, 128}) {
    pause.note(true, 0.0);
    EXPECT_EQ(rest_of(pause), expected);
  }
  for (int step = 0; step < 130 + 66; ++step) pause.note(false, 0.0);
  pause.note(true, 0.0);
  EXPECT_EQ(rest_of(pause), 64);
  for (int step = 0; step < 1'000; ++step) pause.note(false, 0.0);
  pause.note(true, 0.0);
  EXPECT_EQ(rest_of(pause), 8);
}

TEST(ChangePause, BeginsAnewWhileItLastsAndEndsWhereTheViewpointsGoElsewhere) {
  ChangePause pause;
  pause.note(true, 0.0);
  pause.note(false, 0.0);
  pause.note(true, 0.0);  // no second one
  EXPECT_EQ(rest_of(pause), 8);
  for (int i = 0; i < 6; ++i) pause.note(true, 0.0), rest_of(pause);
  pause.note(true, 0.5);
  EXPECT_TRUE(pause.holds());
  pause.note(false, 1.5);
  EXPECT_FALSE(pause.holds());
  pause.note(true, 1.5);
  EXPECT_EQ(rest_of(pause, 1.5), 8);
}

// Whoever went up in such a heap moved its neighbours, which cost more than there was room for, and so on for
// ever: 1,452 changes of rung in ten seconds of these four heaps, now 284.
TEST(ChangePause, AHeapUnderABudgetComesToRest) {
  const std::vector<std::shared_ptr<const Shape>> shapes{
      box_shape({0.2, 0.3, 0.4}), box_shape({0.3, 0.3, 0.3}), sphere_shape(0.15), box_shape({0.4, 0.4, 0.05}),
      std::make_shared<const Shape>(make_shape("l", make_l(0.3, 0.3, 0.1, 0.1)))};
  std::size_t changes = 0;
  for (const auto& [budget, seed] : {std::pair{3e3, 1u}, {3e3, 2u}, {4e3, 1u}, {4e3, 2u}}) {
    Manager manager = on_floor({.policy = {.policy = WorkPolicy{budget}}, .signatures = coarse_signature});
    RandomStream random(11, seed, 0);
    for (int i = 0; i < 400; ++i)
      manager.add_body(
          {.shape = shapes[std::size_t(random.uniform(0.0, 4.999))],
           .state = {.position = {random.uniform(-0.8, 0.8), random.uniform(-0.8, 0.8), 0.4 + 0.02 * i},
                     .orientation = random.orientation()}});
    view_from(manager, {0, -3, 1.5});
    for (int step = 0; step < 1'500; ++step) {
      manager.step(kFrame);
      if (step >= 900) changes += manager.rung_changes().size();
    }
  }
  EXPECT_LT(changes, 800u);
}

}  // namespace
}  // namespace lodestone::change_pause_test
