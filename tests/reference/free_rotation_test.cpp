#include "reference/free_rotation.h"

#include <gtest/gtest.h>

#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

using testing::box_shape;

const Quat kTilted = rotation_from_vector(Vec3(0.3, -0.7, 1.1));

TEST(FreeRotation, SpinAndAngularVelocityAreEachOthersInverse) {
  const auto box = box_shape({0.2, 0.3, 0.4});
  const Vec3 omega(1, -2, 3);
  const Vec3 spin = spin_of(kTilted, omega, *box);
  EXPECT_LT((angular_velocity(kTilted, spin, *box) - omega).norm(), 1e-14);
  EXPECT_LT((inverse_inertia_world(kTilted, *box) * spin - omega).norm(), 1e-14);
}

// ½v² + ½ Σ Iᵢωᵢ², with I of a box over its mass (b² + c²)/12.
TEST(FreeRotation, EnergyIsThatOfTheBodyAxes) {
  const auto box = box_shape({0.2, 0.3, 0.4});
  const Vec3 in_body(4, 5, 6);
  const RigidState state{Vec3::Zero(), kTilted, {1, 2, 3}, kTilted * in_body};
  const double turning = (16 * (0.09 + 0.16) + 25 * (0.04 + 0.16) + 36 * (0.04 + 0.09)) / 24.0;
  EXPECT_NEAR(kinetic_energy(*box, state), 7.0 + turning, 1e-13);
}

TEST(FreeRotation, AboutAPrincipalAxisItTurnsByTheAngle) {
  const auto box = box_shape({0.2, 0.3, 0.4});
  const Vec3 omega = kTilted * Vec3(0, 0, 5);
  const Quat later = advance_orientation(kTilted, spin_of(kTilted, omega, *box), *box, 0.2);
  EXPECT_LT(later.angularDistance(kTilted * rotation_from_vector(Vec3(0, 0, 1.0))), 1e-7);
  EXPECT_LT((later.coeffs() - (kTilted * rotation_from_vector(Vec3(0, 0, 1.0))).coeffs()).norm(), 1e-14);
}

// A symmetric top has ω = L/I₁ + ω₃ (1 − I₃/I₁) e₃, both parts of constant length: its orientation is
// exp(t L/I₁) R exp(t ω₃ (1 − I₃/I₁) e₃). Halving the step quarters the error.
TEST(FreeRotation, FollowsASymmetricTopToSecondOrder) {
  const auto top = box_shape({0.2, 0.2, 0.5});
  const double i1 = top->inertia_per_mass(0, 0), i3 = top->inertia_per_mass(2, 2);
  const Vec3 omega_in_body(2, 1, 6), spin = spin_of(kTilted, kTilted * omega_in_body, *top);
  const double time = 1.0;
  const Quat exact = rotation_from_vector(spin / i1 * time) * kTilted *
                     rotation_from_vector(Vec3(0, 0, omega_in_body.z() * (1.0 - i3 / i1) * time));
  const auto error = [&](int steps) {
    Quat q = kTilted;
    for (int i = 0; i < steps; ++i) q = advance_orientation(q, spin, *top, time / steps);
    return q.angularDistance(exact);
  };
  EXPECT_LT(error(1000), 1e-4);
  EXPECT_NEAR(error(100) / error(200), 4.0, 0.1);
  EXPECT_NEAR(error(200) / error(400), 4.0, 0.1);
}

}  // namespace
}  // namespace lodestone
