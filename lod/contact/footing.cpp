#include "lod/contact/footing.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace lodestone {
namespace {

constexpr double kBears = 0.2;      // cosine: so far up a normal bears
constexpr double kTouches = 0.005;  // over R, and over the width of the area that it would stand on, so that
                                    // it is tilted by no more (rad): gaps of points that it stands on
constexpr double kLevel = 1e-4;     // over R: what is raised by no more is not
constexpr double kBeyond = 0.005;   // over R: so far the area reaches beyond the place below its centre

bool is_free(std::span<const SolverBody> bodies, std::int32_t body) {
  return body >= 0 && bodies[std::size_t(body)].inverse_mass > 0.0;
}

}  // namespace

void Footing::find(std::span<const SolverBody> bodies, std::span<const double> radii,
                   std::span<const CrowdManifold> manifolds, std::span<const CrowdPoint> points,
                   const Vec3& up) {
  const Vec3 along = up.unitOrthogonal(), across = up.cross(along);
  std::array<std::array<float, 2>, kWays> ways;
  for (std::size_t k = 0; k < kWays; ++k) {
    const double angle = 2.0 * std::numbers::pi * double(k) / double(kWays);
    ways[k] = {float(std::cos(angle)), float(std::sin(angle))};
  }
  std::array<float, kWays> nowhere;
  nowhere.fill(-1.0F);
  reach_.assign(bodies.size(), nowhere);
  carries_.assign(manifolds.size(), 0);
  const auto stand = [&](std::int32_t body, const Vec3& arm) {
    const auto x = float(arm.dot(along)), y = float(arm.dot(across));
    std::array<float, kWays>& reach = reach_[std::size_t(body)];
    for (std::size_t k = 0; k < kWays; ++k) reach[k] = std::max(reach[k], ways[k][0] * x + ways[k][1] * y);
  };
  for (std::size_t i = 0; i < manifolds.size(); ++i) {
    const CrowdManifold& m = manifolds[i];
    const double cosine = m.normal.dot(up);
    const bool bears_first = cosine > kBears && is_free(bodies, m.first),
               bears_second = cosine < -kBears && is_free(bodies, m.second);
    if (!bears_first && !bears_second) continue;
    const auto own = points.subspan(m.begin, m.count);
    carries_[i] = std::ranges::any_of(own, [](const CrowdPoint& p) { return !p.impulse.isZero(0.0); });
    if (!carries_[i]) continue;
    const std::int32_t body = bears_first ? m.first : m.second;
    const auto arm_of = [&](const CrowdPoint& p) { return bears_first ? p.arm_first : p.arm_second; };
    const auto find_width = [&] {  // m
      double width = 1e300;
      for (const auto& [x, y] : ways) {
        double from = 1e300, to = -1e300;
        for (const CrowdPoint& p : own) {
          const double at = arm_of(p).dot(double(x) * along + double(y) * across);
          from = std::min(from, at), to = std::max(to, at);
        }
        width = std::min(width, to - from);
      }
      return width;
    };
    const double radius = radii[std::size_t(body)],
                 nearest = std::max(0.0, std::ranges::min(own, {}, &CrowdPoint::gap).gap),
                 level = nearest + kLevel * radius;
    double raised = -1.0;  // m, once it is asked for
    for (const CrowdPoint& p : own) {
      if (p.gap >= kTouches * radius) continue;
      if (p.gap > level && raised < 0.0) raised = nearest + kTouches * find_width();
      if (p.gap <= std::max(level, raised)) stand(body, arm_of(p));
    }
  }
  tips_.assign(bodies.size(), 0);
  for (std::size_t i = 0; i < bodies.size(); ++i)
    tips_[i] = radii[i] > 0.0 && bodies[i].inverse_mass > 0.0 &&
               std::ranges::min(reach_[i]) < float(kBeyond * radii[i]);
  hand_on(bodies, radii, manifolds, up);
}

// What stands on one that tips goes with it.
void Footing::hand_on(std::span<const SolverBody> bodies, std::span<const double> radii,
                      std::span<const CrowdManifold> manifolds, const Vec3& up) {
  bool any = true;
  const auto hand_on = [&](std::size_t i) {
    if (!carries_[i]) return;
    const CrowdManifold& m = manifolds[i];
    const bool first_above = m.normal.dot(up) > 0.0;
    const std::int32_t above = first_above ? m.first : m.second, below = first_above ? m.second : m.first;
    if (!is_free(bodies, below) || !tips_[std::size_t(below)] || tips_[std::size_t(above)] ||
        radii[std::size_t(above)] == 0.0)
      return;
    tips_[std::size_t(above)] = any = true;
  };
  while (std::exchange(any, false)) {  // to and fro: stacks stand in their order, or against it
    for (std::size_t i = 0; i < manifolds.size(); ++i) hand_on(i);
    for (std::size_t i = manifolds.size(); i-- > 0;) hand_on(i);
  }
}

}  // namespace lodestone
