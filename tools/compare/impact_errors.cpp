#include "tools/compare/impact_errors.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "reference/error.h"
#include "tools/median.h"

namespace lodestone {
namespace {

constexpr double kNoticed = 0.1;  // of an impulse

double angle_deg_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / std::numbers::pi;
}

}  // namespace

std::optional<ImpactErrors> measure_impact_errors(std::span<const DropObservation> truth,
                                                  std::span<const DropObservation> method) {
  check_that(truth.size() == method.size(), "drops are compared start by start");
  std::vector<double> impulses, angles, speeds;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (!truth[i].first_impact || !method[i].first_impact) continue;
    const FirstImpact &expected = *truth[i].first_impact, &found = *method[i].first_impact;
    impulses.push_back((found.impulse() - expected.impulse()).norm() / expected.impulse().norm() / kNoticed);
    angles.push_back(angle_deg_between(found.after, expected.after));
    if (const double speed = expected.after.norm(); speed > 0.0)
      speeds.push_back(found.after.norm() / speed - 1.0);
  }
  if (impulses.empty()) return {};
  return ImpactErrors{
      .impacts = int(impulses.size()),
      .impulse_median = median_of(impulses),
      .impulse_mean = mean_of(impulses),
      .unnoticed = double(std::ranges::count_if(impulses, [](double error) { return error <= 1.0; })) /
                   double(impulses.size()),
      .angle_deg = median_of(angles),
      .speed_change = speeds.empty() ? 0.0 : mean_of(speeds)};
}

}  // namespace lodestone
