#include "lod/contact/free_way.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "lod/contact/hull_contacts.h"
#include "lod/contact/solid_contacts.h"

namespace lodestone {

double find_free_way(const MetGround& ground, const Vec3& center, const Vec3& way, double radius,
                     const ReachFunction& reach_of) {
  constexpr int kMostLooks = 16;
  constexpr double kArrived = 1e-3;   // over the way that was left
  constexpr double kTouching = 0.01;  // over the radius
  thread_local std::vector<GroundNear> near;
  thread_local std::vector<std::pair<const GroundPart*, std::uint32_t>> touched;
  touched.clear();
  double gone = 0.0;
  for (int look = 0; look < kMostLooks; ++look) {
    const Vec3 left = (1.0 - gone) * way;
    double free = 1.0;
    near.clear();
    find_ground_near(ground, center + gone * way, (1.0 + kTouching) * radius + left.norm(), 0.0, near,
                     nullptr, Seams::there);
    for (const GroundNear& n : near) {
      const double gap = n.height - reach_of(-n.normal), closing = -n.normal.dot(left);
      const std::pair solid(n.part, n.number);
      if (look == 0 && gap <= kTouching * radius) touched.push_back(solid);
      if (closing <= 0.0 || std::ranges::find(touched, solid) != touched.end()) continue;
      free = std::min(free, std::max(0.0, gap) / closing);
    }
    gone += free * (1.0 - gone);
    if (free >= 1.0) return 1.0;
    if (free < kArrived) break;
  }
  return gone;
}

double find_free_way(const MetGround& ground, const StatisticalBody& body, const Shape& shape,
                     const Vec3& from, const Vec3& way) {
  const auto reach_of = [&](const Vec3& direction) {
    if (body.is_sphere()) return double(body.sphere_radius);
    std::int32_t hint = body.support_hint;
    return -find_lowest_point(shape, body.orientation, -direction, 0.0, hint).gap;
  };
  return find_free_way(ground, from, way, shape.radius, reach_of);
}

}  // namespace lodestone
