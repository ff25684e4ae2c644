// Rows of dominoes: what turns over its edge falls as fast as in ODE, hops of a hair or not.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

constexpr int kDominoes = 20;
constexpr double kApart = 0.4, kLeans = 0.45;  // m between them; rad: has fallen against the next one

/// s from the push until the last one leans; infinite where it never does.
double time_to_last(LevelChoice level, const ContactLaw& law) {
  ManagerSettings settings = unmeasured();
  settings.full_substeps = 16;
  Manager manager = on_floor(settings);
  manager.materials().set_law(0, 0, law);
  const auto domino = box_shape({0.1, 0.4, 0.8});
  std::vector<BodyId> row;
  for (int i = 0; i < kDominoes; ++i)
    row.push_back(add(manager, domino, testing::at({kApart * i, 0, 0.4}), level));
  run(manager, 0.5);
  manager.add_impulse(row[0], Vec3(0.7 * manager.mass(row[0]), 0, 0),
                      manager.state(row[0]).position + Vec3(0, 0, 0.38));
  for (double time = 0.0; time < 8.0; time += kFrame) {
    manager.step(kFrame);
    if ((manager.state(row.back()).orientation * Vec3::UnitZ()).z() < std::cos(kLeans)) return time;
  }
  return 1e300;
}

TEST(Dominoes, FallAsFastAsInOde) {
  for (const ContactLaw& law : {ContactLaw{.restitution = 0.1, .friction = 0.5},
                                {.restitution = 0.5, .friction = 0.5},
                                {.restitution = 0.5, .friction = 1.0}}) {
    const double full = time_to_last(LevelChoice::full, law);
    EXPECT_NEAR(time_to_last(LevelChoice::support, law) / full, 1.0, 0.07)
        << "restitution " << law.restitution << ", friction " << law.friction;
  }
}

}  // namespace
}  // namespace lodestone
