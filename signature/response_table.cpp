#include "signature/response_table.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lodestone {
namespace {

// Where a value lies between cell centres: the lower cell, and the weight of the next.
struct Place {
  int cell = 0;
  float weight = 0.0f;
};

Place place_of(double value, double range, int n, bool interpolate) {
  const double at = value / range * n - 0.5;
  if (!(at > 0.0)) return {0, 0.0f};
  if (at >= n - 1) return {n - 1, 0.0f};
  const int cell = int(at);
  const auto weight = float(at - cell);
  return interpolate ? Place{cell, weight} : Place{cell + (weight >= 0.5f ? 1 : 0), 0.0f};
}

}  // namespace

ResponseStatistics find_response(const ResponseTable& table, double theta, double phi, double alpha, bool interpolate) {
  constexpr double kPi = std::numbers::pi;
  const Place t = place_of(theta, kPi / 2, table.n_theta, interpolate);
  const Place p = place_of(phi, kPi, table.n_phi, interpolate);
  const Place a = place_of(alpha, kPi / 2, table.n_alpha, interpolate);
  ResponseStatistics found;
  found.extrapolated = !(theta >= 0.0 && theta <= kPi / 2 && phi >= 0.0 && phi <= kPi && alpha >= 0.0 && alpha <= kPi / 2);
  for (int corner = 0; corner < 8; ++corner) {
    const bool it = corner & 1, ip = corner & 2, ia = corner & 4;
    const float weight = (it ? t.weight : 1 - t.weight) * (ip ? p.weight : 1 - p.weight) * (ia ? a.weight : 1 - a.weight);
    if (weight == 0.0f) continue;
    const int cell = ((t.cell + it) * table.n_phi + p.cell + ip) * table.n_alpha + a.cell + ia;
    found.mean += weight * table.mean[cell];
    found.deviation += weight * table.deviation[cell];
  }
  return found;
}

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
