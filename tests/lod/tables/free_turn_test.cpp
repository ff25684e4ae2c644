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

class FreeTurn : public ::testing::Test {
 protected:
  FreeTurn() { settings_.gravity = Vec3::Zero(); }

  // For `steps` of `time` each, from the state it has now.
  void keeps_momentum_and_energy(testing::OneRung& level, int slot, double time, int steps) const {
    const RigidState start = level.state(slot);
    const double before = rotational_energy(start, *box_);
    const Vec3 spin = spin_of(start.orientation, start.angular_velocity, *box_);
    for (int i = 0; i < steps; ++i) {
      StepReport report;
      level.step(time, {}, report);
      const RigidState now = level.state(slot);
      ASSERT_NEAR(rotational_energy(now, *box_) / before, 1.0, 1e-6)
          << start.angular_velocity.transpose() << ", " << time << ", " << i;
      ASSERT_LT((spin_of(now.orientation, now.angular_velocity, *box_) - spin).norm(), 1e-6 * spin.norm())
          << start.angular_velocity.transpose() << ", " << time << ", " << i;
    }
  }

  const Ground ground_;
  const MaterialTable materials_;
  StatisticalSettings settings_;
  const std::shared_ptr<const Shape> box_ = testing::box();
};

// The loop's rule for slow turns, that for fast ones beyond, for 600 steps, about the greatest axis, a free
// one and nearly the middle one. Single precision rounds the orientation in each.
TEST_F(FreeTurn, KeepsMomentumAndEnergy) {
  for (const double w : {0.1, 1.0, 5.0, 10.0, 20.0, 50.0, 500.0, 1e4})
    for (const double step : {1.0 / 600.0, 1.0 / 60.0, 1.0 / 30.0, 0.1})
      for (const Vec3& axis :
           {Vec3(1.0, 0.01, 0.3), Vec3(1.0, 1.0, 1.0), Vec3(0.02, 1.0, 0.02), Vec3(0.001, 1.0, 0.001)}) {
        testing::OneRung level(StatisticalModel::tables, settings_, ground_, materials_);
        RigidState start;
        start.angular_velocity = w * axis;
        const int slot = level.add(0, box_, 24.0, 0, start, false, testing::box_signature());
        keeps_momentum_and_energy(level, slot, step, 600);
      }
}

// A flight's energy is not that of the flight before, however near they are.
TEST_F(FreeTurn, AStateThatIsSetBeginsAFlight) {
  for (const double ratio : {1.0 + 1e-6, 1.0 + 1e-5, 1.0 + 1e-3, 2.0, 1e-3, 0.0}) {
    testing::OneRung level(StatisticalModel::tables, settings_, ground_, materials_);
    RigidState start;
    start.angular_velocity = {10.0, 0.1, 3.0};
    const int slot = level.add(0, box_, 24.0, 0, start, false, testing::box_signature());
    keeps_momentum_and_energy(level, slot, 1.0 / 60.0, 50);
    RigidState other = level.state(slot);
    other.angular_velocity = ratio > 0.0 ? Vec3(ratio * other.angular_velocity) : Vec3(0.3, 0.1, 9.0);
    level.set_state(slot, other);
    keeps_momentum_and_energy(level, slot, 1.0 / 60.0, 50);
  }
}

}  // namespace
}  // namespace lodestone
