// S13.
#include <fmt/format.h>

#include <numbers>

#include "reference/random.h"
#include "signature/measure/contact_time.h"
#include "tools/bench/lone_body_cases.h"
#include "tools/bench/statistical_case_parts.h"

namespace lodestone {
namespace {

constexpr double kPi = std::numbers::pi, kLength = 4.0;  // of the prism whose section is a square of side 1
constexpr double kHalfDiagonal = std::numbers::sqrt2 / 2;

struct Heights { double mean = 0.0, least = 1e300, greatest = 0.0; };

/// Heights of the centre at contact of a prism that turns about its own, level, axis, at `ratio` = ‖ω‖/‖v‖ in radians a side.
Heights measure_heights(const Shape& prism, double ratio, int trials) {
  ContactTime contact_time(prism);
  Heights heights;
  int count = 0;
  for (int trial = 0; trial < trials; ++trial) {
    RandomStream random(113, std::uint64_t(trial), 0);
    RigidState state;
    state.orientation = Quat(Eigen::AngleAxisd(random.uniform(0.0, 2.0 * kPi), Vec3::UnitY()));
    state.position.z() = 1.0;
    state.velocity.z() = -1.0;
    state.angular_velocity.y() = trial % 2 ? ratio : -ratio;
    if (!contact_time.advance(state)) continue;
    heights.mean += state.position.z(), ++count;
    heights.least = std::min(heights.least, state.position.z());
    heights.greatest = worse(heights.greatest, state.position.z());
  }
  heights.mean /= count;
  return heights;
}

}  // namespace

std::vector<HardCaseRow> measure_square_heights(const HardCaseSettings& settings) {
  const int trials = settings.quick ? 500 : 5000;
  const Shape prism = *box_of({1.0, kLength, 1.0});
  const double tolerance = 2e-6 * prism.radius;  // to which contacts are found
  Heights all;
  double fall = 0.0, before = 0.0, last = 0.0, first = 0.0;
  for (const double ratio : {0.0, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0}) {
    const Heights heights = measure_heights(prism, ratio, trials);
    all.least = std::min(all.least, heights.least), all.greatest = worse(all.greatest, heights.greatest);
    fall = worse(fall, before - heights.mean);
    before = last = heights.mean;
    if (ratio == 0.0) first = heights.mean;
  }
  // Without spin the height is √½ cos over an eighth of a turn either way: 2/π in the mean, .0622 in deviation. The faster it spins, the more surely a corner strikes.
  const double sampling = 4.5 * 0.0622 / std::sqrt(double(trials));
  const std::string what = fmt::format("square prism of side 1, {} contacts at each of 8 spins: ", trials);
  return {{.what = what + "least collision height", .value = all.least, .bound = 0.5 - tolerance, .side = BoundSide::at_least},
          {.what = what + "greatest", .value = all.greatest, .bound = kHalfDiagonal + tolerance},
          {.what = what + "mean without spin off 2/pi", .value = std::abs(first - 2.0 / kPi), .bound = sampling},
          {.what = what + "the mean's greatest fall from one spin to the next", .value = fall, .bound = sampling},
          {.what = what + "mean at 100 rad a side off half the diagonal", .value = kHalfDiagonal - last, .bound = 0.01}};
}

}  // namespace lodestone
