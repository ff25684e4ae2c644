// Spheres that turn freely keep their angular momentum and, to single precision, their energy.
#include "lod/tables/free_turn.h"

#include <gtest/gtest.h>

#include "reference/free_rotation.h"
#include "tests/lod/rungs/rung_fixture.h"

namespace lodestone {
namespace {

double rotational_energy(const RigidState& s, const Shape& shape) {
  return 0.5 * s.angular_velocity.dot(spin_of(s.orientation, s.angular_velocity, shape));
}

// The loop's rule for slow turns, that for fast ones beyond, for 600 steps. Single precision rounds the
// orientation in each.
TEST(FreeTurn, KeepsMomentumAndEnergy) {
  const Ground ground;
  const MaterialTable materials;
  StatisticalSettings settings;
  settings.gravity = Vec3::Zero();
  for (const double w : {1.0, 10.0, 20.0, 50.0, 500.0})
    for (const double step : {1.0 / 60.0, 1.0 / 30.0, 0.1}) {
      testing::OneRung level(StatisticalModel::tables, settings, ground, materials);
      RigidState start;
      start.angular_velocity = w * Vec3(1.0, 0.01, 0.3);
      const int slot = level.add(0, testing::box(), 24.0, 0, start, false, testing::box_signature());
      const double before = rotational_energy(start, *testing::box());
      const Vec3 spin = spin_of(start.orientation, start.angular_velocity, *testing::box());
      for (int i = 0; i < 600; ++i) {
        StepReport report;
        level.step(step, {}, report);
        const RigidState now = level.state(slot);
        ASSERT_NEAR(rotational_energy(now, *testing::box()) / before, 1.0, 1e-5)
            << w << ", " << step << ", " << i;
        ASSERT_LT((spin_of(now.orientation, now.angular_velocity, *testing::box()) - spin).norm(),
                  1e-6 * spin.norm())
            << w << ", " << step << ", " << i;
      }
    }
}

}  // namespace
}  // namespace lodestone
