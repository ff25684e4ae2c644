// Bodies that are much thinner than what they move in a substep.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone::plates_test {
namespace {

using namespace testing;

constexpr double kThickness = 0.004;  // m

struct Stack {
  double energy_ratio;  // the greatest over that at the start
  double top;           // m, at the end
  int asleep;
};

// 20 plates over each other, `gap` (m) apart, each turned by `turn` (rad) against the one below.
Stack drop_plates(double gap, double turn) {
  Manager manager = on_floor();
  const auto plate = box_shape({0.3, 0.3, kThickness});
  std::vector<BodyId> plates;
  for (int i = 0; i < 20; ++i) {
    RigidState state = at({0, 0, 0.5 * kThickness + gap + i * (kThickness + gap)});
    state.orientation = rotation_from_vector({0, 0, turn * i});
    plates.push_back(add(manager, plate, state, LevelChoice::full));
  }
  const auto energy_of_all = [&] {
    double sum = 0.0;
    for (const BodyId body : plates) sum += energy(manager, body);
    return sum;
  };
  const double at_first = energy_of_all();
  Stack stack{1.0, 0.0, 0};
  for (int i = 0; i < 240; ++i) {
    manager.step(kFrame);
    stack.energy_ratio = std::max(stack.energy_ratio, energy_of_all() / at_first);
  }
  for (const BodyId body : plates) {
    stack.top = std::max(stack.top, manager.state(body).position.z());
    stack.asleep += manager.asleep(body);
  }
  return stack;
}

// dWorldStep gives up on some of their steps, which are done again by QuickStep.
TEST(Plates, AStackThatFallsGainsNoEnergyAndComesToRest) {
  const Stack stack = drop_plates(0.001, 0.0);
  EXPECT_LT(stack.energy_ratio, 1.01);
  EXPECT_NEAR(stack.top, 19.5 * kThickness, kThickness);
  EXPECT_EQ(stack.asleep, 20);
}

// A blow from the floor goes up by one plate a substep: more substeps than were asked for.
TEST(Plates, AStackThatLiesOnItselfIsNotTornApart) {
  const Stack stack = drop_plates(0.0, 0.0);
  EXPECT_LT(stack.energy_ratio, 1.05);
  EXPECT_NEAR(stack.top, 19.5 * kThickness, kThickness);
}

TEST(Plates, TurnedAgainstEachOtherTheyComeToRest) {
  const Stack stack = drop_plates(0.014, 0.2);
  EXPECT_LT(stack.energy_ratio, 1.01);
  EXPECT_NEAR(stack.top, 19.5 * kThickness, kThickness);
  EXPECT_EQ(stack.asleep, 20);
}

// A substep that is done again leaves those alone that slept: their last state before has a speed.
TEST(Plates, SleepersElsewhereKeepStill) {
  Manager manager = on_floor();
  const BodyId ball = add(manager, std::make_shared<const Shape>(make_sphere_shape(0.15)),
                          at({5, 0, 0.15}, {1e-3, 0, 0}), LevelChoice::full);
  for (int i = 0; i < 600 && !manager.asleep(ball); ++i) manager.step(kFrame);
  ASSERT_TRUE(manager.asleep(ball));
  const RigidState asleep = manager.state(ball);
  for (int i = 0; i < 20; ++i)
    add(manager, box_shape({0.3, 0.3, kThickness}),
        at({0, 0, 0.5 * kThickness + 0.001 + i * (kThickness + 0.001)}), LevelChoice::full);
  for (int i = 0; i < 60; ++i) {
    manager.step(kFrame);
    ASSERT_EQ(manager.state(ball).velocity, asleep.velocity) << i;
    ASSERT_EQ(manager.state(ball).position, asleep.position) << i;
  }
}

}  // namespace
}  // namespace lodestone::plates_test
