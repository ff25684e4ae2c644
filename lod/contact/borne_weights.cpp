#include "lod/contact/borne_weights.h"

#include <algorithm>
#include <cmath>

namespace lodestone {
namespace {

constexpr double kSteepest = 0.5;  // cosine of the angle from the vertical to a normal that bears weight
constexpr double kRestingApproach = 2.0;  // of what gravity adds to a velocity in the step

bool moves(std::span<const SolverBody> bodies, std::int32_t body) {
  return body >= 0 && bodies[std::size_t(body)].inverse_mass > 0.0;
}

// m/s along the normal, at one of its points; positive where they part.
double parting_of(std::span<const SolverBody> bodies, const CrowdManifold& m, const CrowdPoint& point) {
  const auto along = [&](std::int32_t body, const Vec3& arm) {
    if (body < 0) return 0.0;
    const SolverBody& at = bodies[std::size_t(body)];
    return (at.velocity + at.angular_velocity.cross(arm)).dot(m.normal);
  };
  return along(m.first, point.arm_first) - along(m.second, point.arm_second);
}

}  // namespace

void BorneWeights::find_supports(std::span<const SolverBody> bodies, std::span<const CrowdManifold> manifolds,
                                 std::span<const CrowdPoint> points, double step) {
  for (std::size_t i = 0; i < manifolds.size(); ++i) {
    const CrowdManifold& m = manifolds[i];
    const double cosine = m.normal.dot(up_);
    if (m.count == 0 || std::abs(cosine) < kSteepest) continue;
    std::int32_t upper = moves(bodies, m.first) ? m.first : -1,
                 lower = moves(bodies, m.second) ? m.second : -1;
    if (cosine < 0.0) std::swap(upper, lower);
    if (m.known) {
      double borne = 0.0;
      for (const CrowdPoint& point : points.subspan(m.begin, m.count))
        borne += std::abs(point.guess.dot(up_));
      if (upper >= 0) places_[std::size_t(upper)].weight -= borne;
      if (lower >= 0) places_[std::size_t(lower)].weight += borne;
      continue;
    }
    const CrowdPoint& point = points[m.begin];
    const bool rests =
        point.gap <= fall_ * step && std::abs(parting_of(bodies, m, point)) <= kRestingApproach * fall_;
    if (!rests || upper < 0) continue;
    Place& place = places_[std::size_t(upper)];
    supports_.push_back({std::uint32_t(i), upper, lower, place.below});
    place.below = std::int32_t(supports_.size()) - 1;
    place.points_below += m.count;
    if (lower >= 0) ++places_[std::size_t(lower)].awaited_above;
  }
}

void BorneWeights::hand_on(std::span<const CrowdManifold> manifolds, std::span<CrowdPoint> points) {
  ready_.clear();
  for (std::size_t i = 0; i < places_.size(); ++i)
    if (places_[i].awaited_above == 0 && places_[i].below >= 0) ready_.push_back(std::int32_t(i));
  while (!ready_.empty()) {
    const Place& place = places_[std::size_t(ready_.back())];
    ready_.pop_back();
    const double share = std::max(0.0, place.weight) / place.points_below;
    for (std::int32_t i = place.below; i >= 0; i = supports_[std::size_t(i)].next) {
      const Support& support = supports_[std::size_t(i)];
      const CrowdManifold& m = manifolds[support.manifold];
      for (CrowdPoint& point : points.subspan(m.begin, m.count))
        point.guess = share / std::abs(m.normal.dot(up_)) * m.normal;  // which points into the first
      if (support.lower < 0) continue;
      Place& lower = places_[std::size_t(support.lower)];
      lower.weight += share * m.count;
      if (--lower.awaited_above == 0 && lower.below >= 0) ready_.push_back(support.lower);
    }
  }
}

void BorneWeights::guess(std::span<const SolverBody> bodies, std::span<const CrowdManifold> manifolds,
                         std::span<CrowdPoint> points, const Vec3& fall, double step) {
  fall_ = fall.norm();
  if (fall_ == 0.0 || std::ranges::all_of(manifolds, &CrowdManifold::known)) return;
  up_ = -fall / fall_;
  supports_.clear();
  places_.assign(bodies.size(), {});
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (bodies[i].inverse_mass > 0.0) places_[i].weight = fall_ / bodies[i].inverse_mass;
  find_supports(bodies, manifolds, points, step);
  if (!supports_.empty()) hand_on(manifolds, points);
}

}  // namespace lodestone
