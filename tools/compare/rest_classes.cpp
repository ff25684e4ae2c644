#include "tools/compare/rest_classes.h"

#include <algorithm>
#include <cmath>

namespace lodestone {
namespace {

const double kNear = std::cos(kRestClassAngle);

// The direction with the most others near it.
Vec3 find_densest(std::span<const Vec3> ups) {
  const auto count_near = [&](const Vec3& center) {
    return std::ranges::count_if(ups, [&](const Vec3& up) { return up.dot(center) >= kNear; });
  };
  return *std::ranges::max_element(ups, {}, count_near);
}

}  // namespace

RestClasses make_rest_classes(std::span<const Vec3> ups) {
  RestClasses classes;
  std::vector<Vec3> left(ups.begin(), ups.end());
  while (!left.empty()) {
    const Vec3 center = find_densest(left);
    classes.push_back(center);
    std::erase_if(left, [&](const Vec3& up) { return up.dot(center) >= kNear; });
  }
  return classes;
}

std::optional<int> find_rest_class(const RestClasses& classes, const Vec3& up) {
  const auto nearest =
      std::ranges::max_element(classes, {}, [&](const Vec3& center) { return center.dot(up); });
  if (nearest == classes.end() || nearest->dot(up) < kNear) return std::nullopt;
  return int(nearest - classes.begin());
}

}  // namespace lodestone
