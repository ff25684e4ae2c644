#include "lod/contact/contact_solver.h"

#include <algorithm>
#include <cmath>

namespace lodestone {

// With v₀ the velocity before the step's gravity a, the gap h is closed at vᵢ = −√(v₀² − 2 a h), after
// t = −2 h/(v₀ + vᵢ) (v is linear in time, so h is the mean velocity times t); then −e vᵢ, and a for what is
// left.
double bounce_in_fall(double restitution, double gap, double approach, double fall, double step) {
  const double before = approach - fall, acceleration = fall / step, way = std::max(0.0, gap);
  const double impact = -std::sqrt(std::max(0.0, before * before - 2.0 * acceleration * way));
  const double time = before + impact < 0.0 ? std::clamp(-2.0 * way / (before + impact), 0.0, step) : 0.0;
  return -restitution * impact + acceleration * (step - time);
}

}  // namespace lodestone
