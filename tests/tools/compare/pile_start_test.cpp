#include "tools/compare/pile_start.h"

#include <gtest/gtest.h>

#include "reference/error.h"

namespace lodestone {
namespace {

void expect_apart(const Shape& shape, std::span<const RigidState> states) {
  for (std::size_t i = 0; i < states.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      EXPECT_GE((states[i].position - states[k].position).norm(), 2 * shape.radius) << i << ", " << k;
}

TEST(PileStart, NobodyIsWithinAnother) {
  const Shape shape = make_shape("box", make_box({0.2, 0.3, 0.4}));
  const std::vector<RigidState> states = make_pile_start(shape, {.bodies = 60, .side = 1.6}, 3);
  ASSERT_EQ(states.size(), 60U);
  expect_apart(shape, states);
  for (const RigidState& state : states) {
    EXPECT_EQ(state.velocity, Vec3::Zero());
    EXPECT_EQ(state.angular_velocity, Vec3::Zero());
    EXPECT_NEAR(state.orientation.norm(), 1.0, 1e-14);
    for (const HalfSpace& plane : make_bin(1.6)) EXPECT_GE(plane.height_of(state.position), shape.radius);
  }
}

TEST(PileStart, IsOfItsSeedAlone) {
  const Shape shape = make_sphere_shape(0.1);
  const auto one = make_pile_start(shape, {}, 1), again = make_pile_start(shape, {}, 1),
             other = make_pile_start(shape, {}, 2);
  EXPECT_EQ(one[7].position, again[7].position);
  EXPECT_NE(one[7].position, other[7].position);
}

TEST(PileStart, ABinHasAFloorAndFourWallsThatFaceInwards) {
  const std::vector<HalfSpace> bin = make_bin(2.0);
  ASSERT_EQ(bin.size(), 5U);
  for (const HalfSpace& plane : bin) {
    EXPECT_NEAR(plane.normal.norm(), 1.0, 1e-15);
    EXPECT_GT(plane.height_of({0, 0, 0.5}), 0.4);
  }
  EXPECT_THROW(check_pile(make_sphere_shape(0.1), {.bodies = 10, .side = 0.15}), InputError);
  EXPECT_NO_THROW(check_pile(make_sphere_shape(0.1), {.bodies = 10, .side = 0.5}));
}

// Each on its way to the middle, there after a second.
TEST(ConvergingStart, AllArriveAtOnce) {
  const Shape shape = make_sphere_shape(0.1);
  const std::vector<RigidState> states = make_converging_start(shape, 27, 4);
  ASSERT_EQ(states.size(), 27U);
  expect_apart(shape, states);
  for (const RigidState& state : states) EXPECT_LT((state.position + state.velocity).norm(), 1e-12);
}

}  // namespace
}  // namespace lodestone
