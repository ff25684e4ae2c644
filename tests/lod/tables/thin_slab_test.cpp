// Bodies of `tables` that others press into the ground stay on the side that they came from.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "reference/random.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone::thin_slab_test {
namespace {

using namespace testing;

TEST(ThinSlab, NobodyOfAColumnThatLandsIsPressedThrough) {
  constexpr double kSide = 0.1, kThickness = 0.02, kHeight = 2.0;  // m
  const auto cube = box_shape({kSide, kSide, kSide});
  const auto signature = coarse_signature(*cube, {.restitution = 0.4, .friction = 0.5});
  for (std::uint32_t column = 0; column < 20; ++column) {
    RandomStream random(93, column, 0);
    Manager manager({.signatures = [&](const Shape&, const ContactLaw&) { return signature; }});
    manager.add_static_box({40, 40, kThickness}, {0, 0, -0.5 * kThickness}, Quat::Identity());
    std::vector<BodyId> cubes;
    for (int i = 0; i < 5; ++i)
      cubes.push_back(
          add(manager, cube,
              {.position = {0.03 * random.uniform(-1, 1), 0.03 * random.uniform(-1, 1),
                            kHeight + 1.1 * kSide * i},
               .orientation = Quat(Eigen::AngleAxisd(random.uniform(-0.3, 0.3), random.direction()))},
              LevelChoice::tables));
    for (int step = 0; step < 180; ++step) {
      manager.step(kFrame);
      for (const BodyId body : cubes)
        ASSERT_GT(manager.state(body).position.z(), 0.0) << "column " << column << ", step " << step;
    }
  }
}

// In steps of 1/30 s, of those that fall 20 m onto each other two in five were under it, for half a second.
TEST(PressedIntoAPlane, NobodyOfAHighColumnIsUnderIt) {
  Manager manager = on_floor({.signatures = coarse_signature});
  const auto cube = box_shape({0.2, 0.2, 0.2});
  RandomStream random(94, 0, 0);
  std::vector<BodyId> column;
  for (int i = 0; i < 40; ++i)
    column.push_back(
        add(manager, cube,
            {.position = {random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4), 20.0 + 0.5 * (i / 2)},
             .orientation = random.orientation()},
            LevelChoice::tables));
  double least = 1e300;  // m
  for (int step = 0; step < 120; ++step) {
    manager.step(1.0 / 30.0);
    for (const BodyId body : column) least = std::min(least, manager.state(body).position.z());
  }
  EXPECT_GT(least, 0.0);
}

// What is thinner than a fiftieth of its radius was lifted, in each step, to where it would be that thick,
// and so had no friction: three sheets of plywood went .47 m in ten seconds where friction holds three times
// as much.
TEST(ThinSheets, StayOnEachOtherOnASlope) {
  const Vec3 sides(2.4, 1.2, 0.018);  // m
  const auto sheet = box_shape(sides);
  const double angle = 10.0 * std::numbers::pi / 180.0;
  Manager manager(
      {.gravity = 9.81 * Vec3(std::sin(angle), 0, -std::cos(angle)), .signatures = coarse_signature});
  manager.materials().replace(0, {.restitution = 0.0, .friction = 0.6});
  manager.add_plane(Vec3::UnitZ(), 0.0);
  std::vector<BodyId> sheets;
  for (int i = 0; i < 3; ++i)
    sheets.push_back(add(manager, sheet, testing::at({0, 0, (i + 0.5) * sides.z()}), LevelChoice::tables));
  run(manager, 10.0);
  for (int i = 0; i < 3; ++i) {
    const RigidState state = manager.state(sheets[std::size_t(i)]);
    EXPECT_LT(state.position.head<2>().norm(), 0.02) << i;
    EXPECT_NEAR(state.position.z(), (i + 0.5) * sides.z(), 0.004) << i;
    EXPECT_TRUE(manager.asleep(sheets[std::size_t(i)])) << i;
  }
}

}  // namespace
}  // namespace lodestone::thin_slab_test
