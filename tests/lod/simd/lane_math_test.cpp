#include "lod/simd/lane_math.h"

#include <gtest/gtest.h>

#include <numbers>

#include "lod/simd/row.h"
#include "reference/random.h"

namespace lodestone::lane {
namespace {

Quat quat_of(const Turn& q) { return {q.w, q.v.x, q.v.y, q.v.z}; }
Vec3 vec_of(F3 a) { return {a.x, a.y, a.z}; }
F3 f3_of(const Vec3& v) { return {float(v.x()), float(v.y()), float(v.z())}; }
Turn turn_of(const Quat& q) { return {float(q.w()), f3_of(q.vec())}; }

TEST(LaneMath, SelectsToTheBit) {
  const float nan = std::nanf(""), minus_zero = -0.0f;
  EXPECT_EQ(select(-1, 1.5f, nan), 1.5f);
  EXPECT_EQ(select(0, nan, 1.5f), 1.5f);
  EXPECT_TRUE(std::signbit(choose(true, minus_zero, 1.0f)));
  EXPECT_EQ(select(std::int64_t(-1), 0.1, 0.2), 0.1);
  EXPECT_EQ(choose(false, 1 << 30, -7), -7);
  EXPECT_EQ(vec_of(choose(true, F3{1, 2, 3}, F3{4, 5, 6})), Vec3(1, 2, 3));
}

TEST(LaneMath, RotationsAreThoseOfQuaternions) {
  RandomStream random(1, 0, 0);
  for (int i = 0; i < 1'000; ++i) {
    const Quat p = random.orientation(), q = random.orientation();
    const Vec3 v = random.direction();
    EXPECT_LT((vec_of(turned(turn_of(q), f3_of(v))) - q * v).norm(), 1e-6);
    EXPECT_LT((vec_of(turned(back(turn_of(q)), f3_of(v))) - q.conjugate() * v).norm(), 1e-6);
    EXPECT_LT((quat_of(product(turn_of(p), turn_of(q))).coeffs() - (p * q).coeffs()).norm(), 1e-6);
  }
}

// The polynomial's own error is 2e-8, the rest single precision's.
TEST(LaneMath, ArcTangentIsExactToRounding) {
  for (int i = 0; i <= 1'000; ++i) {
    const double angle = i * std::numbers::pi / 2000.0;
    for (const double length : {1e-6, 1.0, 1e6})
      EXPECT_NEAR(arc_tangent(float(length * std::sin(angle)), float(length * std::cos(angle))), angle, 4e-7);
  }
  EXPECT_EQ(arc_tangent(0.0f, 0.0f), 0.0f);
  EXPECT_NEAR(arc_tangent(1.0f, 0.0f), std::numbers::pi / 2, 1e-7);
}

// The series end at the 13th power of half the angle: exact to rounding up to half a turn, to π¹⁴/14! = 1e-4
// up to a whole one. Of more turns only what is beyond whole ones is seen.
TEST(LaneMath, TurnsByAnyAngle) {
  const Vec3 axis = Vec3(1, -2, 3).normalized();
  for (const double angle : {0.0, 1e-8, 0.1, 3.0, 6.28, 6.29, 20.0, 1000.0}) {
    const Quat exact = rotation_from_vector(angle * axis),
               found = quat_of(turn_by(f3_of(10 * angle * axis), 0.1f));
    const double beyond = std::fmod(angle, 2.0 * std::numbers::pi),
                 bound = beyond > std::numbers::pi ? 1e-4 : 1e-6;
    EXPECT_NEAR(found.norm(), 1.0, bound) << angle;
    EXPECT_LT(found.normalized().angularDistance(exact), 2 * bound + 2e-7 * angle) << angle;
  }
  EXPECT_NEAR(quat_of(turn_by({1e30f, 0, 0}, 1.0f)).norm(), 1.0, 1e-6);  // of so fast a spin nothing is known
}

TEST(LaneMath, TensorsActInTheBodysAxes) {
  const float xx = 1, yy = 2, zz = 3, xy = 0.1f, xz = 0.2f, yz = 0.3f;
  Mat3 m;
  m << 1, 0.1, 0.2, 0.1, 2, 0.3, 0.2, 0.3, 3;
  const Quat q = rotation_from_vector(Vec3(1, 2, 3));
  const Vec3 v(0.5, -1, 2), expected = q * (m * (q.conjugate() * v));
  EXPECT_LT((vec_of(in_world({&xx, &yy, &zz, &xy, &xz, &yz}, 0, turn_of(q), f3_of(v))) - expected).norm(),
            2e-6);
}

TEST(LaneRows, AddSideBySide) {
  Row row{1, 2, 3, 4};
  add_to(row, lanes_of({10, 20, 30, 40}));
  EXPECT_EQ(row.x, 11);
  EXPECT_EQ(row.w, 44);
  const Row ones = row_of(only_w(lanes_of(row)));
  EXPECT_EQ(ones.x, 1);
  EXPECT_EQ(ones.z, 1);
  EXPECT_EQ(ones.w, 44);
}

}  // namespace
}  // namespace lodestone::lane
