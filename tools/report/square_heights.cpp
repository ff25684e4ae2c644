#include "tools/report/square_heights.h"

#include <cmath>
#include <numbers>

#include "reference/random.h"
#include "reference/shape.h"
#include "signature/measure/contact_time.h"

namespace lodestone {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kHalfDiagonal = std::numbers::sqrt2 / 2;

double phase_sum(double phi, double ratio) { return phi + ratio * kHalfDiagonal * std::cos(phi); }

// Where the sum, a quarter of a turn later, comes to what it was at `last`: by bisection, since it rises from
// −π/4 to `last`.
double first_met(double last, double ratio) {
  double low = -kPi / 4, high = last;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (phase_sum(middle, ratio) + kPi / 2 < phase_sum(last, ratio) ? low : high) = middle;
  }
  return low;
}

}  // namespace

double mean_square_height(double ratio) {
  if (ratio <= 2.0) return 2.0 / kPi;
  const double last = std::asin(std::numbers::sqrt2 / ratio), first = first_met(last, ratio);
  const double a = std::sin(first), b = std::sin(last);
  return 2.0 / kPi * (kHalfDiagonal * (b - a) - 0.25 * ratio * (b * b - a * a));
}

double measure_square_height(double ratio, int trials) {
  static const Shape prism = make_shape("prism", make_box({1.0, 4.0, 1.0}));
  ContactTime contact_time(prism);
  double sum = 0.0;
  for (int trial = 0; trial < trials; ++trial) {
    RandomStream random(113, std::uint64_t(trial), 0);
    RigidState state;
    state.orientation = Quat(Eigen::AngleAxisd(random.uniform(0.0, 2.0 * kPi), Vec3::UnitY()));
    state.position.z() = 1.0;
    state.velocity.z() = -1.0;
    state.angular_velocity.y() = trial % 2 ? ratio : -ratio;
    contact_time.advance(state);
    sum += state.position.z();
  }
  return sum / trials;
}

}  // namespace lodestone
