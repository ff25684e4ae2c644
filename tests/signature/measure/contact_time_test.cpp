#include "signature/measure/contact_time.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "reference/free_rotation.h"
#include "reference/random.h"

namespace lodestone {
namespace {

double gap_of(const Shape& shape, const RigidState& state) {
  double lowest = 1e300;
  for (const Vec3& v : shape.hull.vertices) lowest = std::min(lowest, (state.orientation * v).z());
  return state.position.z() + lowest;
}

RigidState random_start(const Shape& shape, double alpha, RandomStream& random) {
  RigidState state;
  state.orientation = random.orientation();
  state.position.z() = shape.radius;
  state.velocity = std::cos(alpha) * Vec3(0.3, 0.0, -1.0);
  state.angular_velocity = std::sin(alpha) / shape.radius * random.direction();
  return state;
}

// The lowest gap on the way there, looked at ten thousand times.
double lowest_gap_before(const Shape& shape, RigidState state, double time) {
  constexpr int kSteps = 10'000;
  const Vec3 spin = spin_of(state.orientation, state.angular_velocity, shape);
  double lowest = 1e300;
  for (int i = 0; i < kSteps; ++i) {
    lowest = std::min(lowest, gap_of(shape, state));
    state.position += state.velocity * (time / kSteps);
    state.orientation = advance_orientation(state.orientation, spin, shape, time / kSteps).normalized();
  }
  return lowest;
}

TEST(ContactTime, StopsWhereTheBodyFirstTouches) {
  for (const Shape& shape :
       {make_shape("box", make_box({0.2, 0.3, 0.4})), make_shape("l", make_l(0.3, 0.2, 0.08, 0.1)),
        make_shape("needle", make_needle(0.4, 0.01))}) {
    ContactTime contact_time(shape);
    for (std::uint32_t i = 0; i < 60; ++i) {
      RandomStream random(1, i, 0);
      const RigidState start = random_start(shape, (i % 12 + 0.5) / 12.0 * std::numbers::pi / 2, random);
      RigidState state = start;
      ASSERT_TRUE(contact_time.advance(state)) << shape.name << i;
      EXPECT_NEAR(gap_of(shape, state), 0.0, 1e-5 * shape.radius) << shape.name << i;
      EXPECT_LT(contact_time.find_lowest(state).velocity, 0.0);
      EXPECT_NEAR(spin_of(start.orientation, start.angular_velocity, shape).norm(),
                  spin_of(state.orientation, state.angular_velocity, shape).norm(), 1e-9);
      const double time = (state.position.z() - start.position.z()) / start.velocity.z();
      EXPECT_GT(lowest_gap_before(shape, start, time), -2e-3 * shape.radius)
          << shape.name << i;  // nothing touched before
    }
  }
}

TEST(ContactTime, ABodyThatRisesNeverTouches) {
  const Shape shape = make_shape("box", make_box({0.2, 0.3, 0.4}));
  ContactTime contact_time(shape);
  RigidState state;
  state.position.z() = shape.radius;
  state.velocity = {1.0, 0.0, 0.01};
  state.angular_velocity = {3.0, -1.0, 2.0};
  EXPECT_FALSE(contact_time.advance(state));
}

// Figure 3: a square of side 1 falling on a line, here a long prism that turns about its length only.
struct SquareHeights {
  std::vector<double> heights;
  double mean() const {
    double sum = 0.0;
    for (const double h : heights) sum += h;
    return sum / double(heights.size());
  }
};

SquareHeights square_heights(double spin_over_speed, int trials) {
  static const Shape prism = make_shape("prism", make_box({1.0, 1.0, 20.0}));
  ContactTime contact_time(prism);
  SquareHeights found;
  for (std::uint32_t i = 0; i < std::uint32_t(trials); ++i) {
    RandomStream random(2, i, 0);
    RigidState state;
    // Its length along y. Its height is far above the square's reach but the prism's bounding sphere is not
    // to matter.
    state.orientation = Quat(Eigen::AngleAxisd(random.uniform(0.0, 2.0 * std::numbers::pi), Vec3::UnitY()) *
                             Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitX()));
    state.position.z() = 1.0 + random.uniform();
    state.velocity = {0.0, 0.0, -1.0};
    state.angular_velocity = {0.0, spin_over_speed * (random.uniform() < 0.5 ? -1.0 : 1.0), 0.0};
    EXPECT_TRUE(contact_time.advance(state));
    found.heights.push_back(state.position.z());
  }
  return found;
}

TEST(ContactTime, SquareFallsFromHalfItsSideToHalfItsDiagonal) {
  const double low = 0.5, high = std::numbers::sqrt2 / 2;
  for (const double ratio : {0.0, 0.1, 0.5, 1.0, 2.0, 5.0, 20.0}) {
    const SquareHeights square = square_heights(ratio, 400);
    EXPECT_GE(std::ranges::min(square.heights), low - 1e-4) << ratio;
    EXPECT_LE(std::ranges::max(square.heights), high + 1e-4) << ratio;
  }
  // It turns by ω/v times what it falls through before a corner comes round again, and meets the line within
  // that of its greatest height.
  EXPECT_GT(square_heights(20.0, 400).mean(), high - 0.04);
  EXPECT_GT(square_heights(100.0, 100).mean(), high - 0.008);
}

TEST(ContactTime, SquareWithoutSpinHasTheHeightsOfARandomOrientation) {
  constexpr int kTrials = 4000;
  SquareHeights square = square_heights(0.0, kTrials);
  // h = √½ cos a with a uniform in ±45°: P(h < x) = 1 − acos(√2 x)/(π/4), mean 2/π.
  std::ranges::sort(square.heights);
  double distance = 0.0;
  for (int i = 0; i < kTrials; ++i) {
    const double expected =
        1.0 - std::acos(std::min(1.0, std::numbers::sqrt2 * square.heights[i])) / (std::numbers::pi / 4);
    distance = std::max(
        {distance, std::abs(expected - double(i) / kTrials), std::abs(expected - (i + 1.0) / kTrials)});
  }
  EXPECT_LT(distance, 1.95 / std::sqrt(double(kTrials)));  // Kolmogorov–Smirnov, p .001
  EXPECT_NEAR(square.mean(), 2.0 / std::numbers::pi, 4.0 * 0.063 / std::sqrt(double(kTrials)));
}

}  // namespace
}  // namespace lodestone
