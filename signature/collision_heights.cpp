#include "signature/collision_heights.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lodestone {

HeightStatistics find_collision_height(const CollisionHeights& heights, double alpha, bool interpolate) {
  const int n = int(heights.mean.size());
  const double at = std::clamp(alpha / (std::numbers::pi / 2), 0.0, 1.0) * (n - 1);
  if (!interpolate || n < 2) {
    const int i = int(std::lround(at));
    return {heights.mean[i], heights.deviation[i]};
  }
  const int i = std::min(int(at), n - 2);
  const double part = at - i;
  return {heights.mean[i] + part * (heights.mean[i + 1] - heights.mean[i]),
          heights.deviation[i] + part * (heights.deviation[i + 1] - heights.deviation[i])};
}

}  // namespace lodestone
