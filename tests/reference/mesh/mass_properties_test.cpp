#include "reference/mesh/mass_properties.h"

#include <gtest/gtest.h>

#include <numbers>

#include "reference/random.h"

namespace lodestone {
namespace {

void expect_close(const Mat3& found, const Mat3& expected, double relative) {
  EXPECT_LE((found - expected).cwiseAbs().maxCoeff(), relative * expected.cwiseAbs().maxCoeff())
      << found << "\n\n"
      << expected;
}

Mat3 box_inertia(const Vec3& sides) {
  const Vec3 squares = sides.cwiseAbs2() / 12.0;
  return Vec3(squares.y() + squares.z(), squares.z() + squares.x(), squares.x() + squares.y()).asDiagonal();
}

TEST(MassProperties, OfABox) {
  const auto mass = measure_mass_properties(make_box({0.2, 0.3, 0.4}));
  EXPECT_NEAR(mass.volume, 0.024, 1e-16);
  EXPECT_LE(mass.center_of_mass.norm(), 1e-16);
  expect_close(mass.inertia_per_mass, box_inertia({0.2, 0.3, 0.4}), 1e-14);
}

TEST(MassProperties, OfATetrahedron) {
  // Corner tetrahedron of unit legs: centroid ¼; ∫x² = 1/60 and ∫xy = 1/120 about the corner, volume 1/6.
  const Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  const auto mass = measure_mass_properties(mesh);
  EXPECT_NEAR(mass.volume, 1.0 / 6.0, 1e-16);
  EXPECT_LE((mass.center_of_mass - Vec3::Constant(0.25)).norm(), 1e-15);
  Mat3 expected = Mat3::Constant(-(0.05 - 0.0625));
  expected.diagonal().setConstant(2.0 * (0.1 - 0.0625));
  expect_close(mass.inertia_per_mass, expected, 1e-13);
}

TEST(MassProperties, OfAnLAreThoseOfItsTwoBoxes) {
  const double a = 0.3, b = 0.2, w = 0.05, t = 0.1;
  const double v1 = a * w * t, v2 = w * (b - w) * t;
  const Vec3 c1(0, (w - b) / 2, 0), c2((w - a) / 2, w / 2, 0), center = (v1 * c1 + v2 * c2) / (v1 + v2);
  const auto shifted = [&](const Mat3& inertia, const Vec3& arm) {
    return Mat3(inertia + arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose());
  };
  const Mat3 expected = (v1 * shifted(box_inertia({a, w, t}), c1 - center) +
                         v2 * shifted(box_inertia({w, b - w, t}), c2 - center)) /
                        (v1 + v2);
  const auto mass = measure_mass_properties(make_l(a, b, w, t));
  EXPECT_NEAR(mass.volume, v1 + v2, 1e-16);
  EXPECT_LE((mass.center_of_mass - center).norm(), 1e-15);
  expect_close(mass.inertia_per_mass, expected, 1e-13);
}

TEST(MassProperties, OfAnIcosphereConvergeToTheSphere) {
  const double volume = 4.0 / 3.0 * std::numbers::pi;
  double previous = 1.0;
  for (int subdivisions = 1; subdivisions <= 5; ++subdivisions) {
    const auto mass = measure_mass_properties(make_sphere(1.0, subdivisions));
    const double error =
        std::abs(mass.volume - volume) / volume + std::abs(mass.inertia_per_mass(0, 0) - 0.4) / 0.4;
    EXPECT_LT(error, 0.3 * previous);  // second order: a quarter each time
    previous = error;
  }
  EXPECT_LT(previous, 3e-3);
}

// As a sheet that is closed by its own back.
TEST(MassProperties, OfWhatHasNoVolumeAreItsMiddleAndNoInertia) {
  const Mesh sheet{.vertices = {{0, 0, 1}, {2, 0, 1}, {0, 4, 1}}, .faces = {{0, 1, 2}, {0, 2, 1}}};
  const MassProperties mass = measure_mass_properties(sheet);
  EXPECT_EQ(mass.volume, 0.0);
  EXPECT_EQ(mass.center_of_mass, Vec3(1, 2, 1));
  EXPECT_FALSE(is_possible_inertia(mass.inertia_per_mass));
}

TEST(MassProperties, MoveAndTurnWithTheMesh) {
  const Mesh mesh = make_l(0.3, 0.2, 0.05, 0.1);
  const auto mass = measure_mass_properties(mesh);
  for (std::uint32_t trial = 0; trial < 20; ++trial) {
    RandomStream random(5, 0, trial);
    const Mat3 turn = random.orientation().toRotationMatrix();
    const Vec3 shift = 10.0 * random.direction();
    Mesh moved = mesh;
    for (Vec3& vertex : moved.vertices) vertex = turn * vertex + shift;
    const auto after = measure_mass_properties(moved);
    EXPECT_NEAR(after.volume, mass.volume, 1e-12 * mass.volume);
    EXPECT_LE((after.center_of_mass - turn * mass.center_of_mass - shift).norm(), 1e-13);
    expect_close(after.inertia_per_mass, turn * mass.inertia_per_mass * turn.transpose(), 1e-12);
  }
}

TEST(Inertia, OfNoPossibleBodyIsTold) {
  EXPECT_TRUE(is_possible_inertia(Mat3::Identity()));
  EXPECT_TRUE(is_possible_inertia(Vec3(1, 1, 2).asDiagonal()));  // a flat plate: I1 + I2 = I3
  EXPECT_TRUE(is_possible_inertia(Vec3(1e-8, 1, 1).asDiagonal()));
  EXPECT_FALSE(is_possible_inertia(Vec3(1, 1, 2.001).asDiagonal()));
  EXPECT_FALSE(is_possible_inertia(Vec3(1, 1, 100).asDiagonal()));
  EXPECT_FALSE(is_possible_inertia(Vec3(0, 1, 1).asDiagonal()));
  EXPECT_FALSE(is_possible_inertia(Vec3(-1, 1, 1).asDiagonal()));
  EXPECT_FALSE(is_possible_inertia(Mat3::Constant(std::nan(""))));
  Mat3 skew = Mat3::Identity();
  skew(0, 1) = 0.1;
  EXPECT_FALSE(is_possible_inertia(skew));
}

}  // namespace
}  // namespace lodestone
