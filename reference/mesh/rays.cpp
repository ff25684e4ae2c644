#include "reference/mesh/rays.h"

#include <algorithm>

namespace lodestone {

bool enters_box(const Eigen::AlignedBox3d& box, double margin, const Vec3& from, const Vec3& direction,
                double length) {
  double first = 0.0, last = length;
  for (int a = 0; a < 3; ++a) {
    const double low = box.min()[a] - margin - from[a], high = box.max()[a] + margin - from[a];
    if (direction[a] == 0.0) {
      if (low > 0.0 || high < 0.0) return false;
      continue;
    }
    const double one = low / direction[a], other = high / direction[a];
    first = std::max(first, std::min(one, other));
    last = std::min(last, std::max(one, other));
  }
  return first <= last;
}

std::optional<double> meet_front(const std::array<Vec3, 3>& t, const Vec3& from, const Vec3& direction,
                                 double length) {
  const Vec3 ab = t[1] - t[0], ac = t[2] - t[0], p = direction.cross(ac);
  const double determinant = ab.dot(p);
  if (determinant <= 0.0) return {};
  const Vec3 to = from - t[0], q = to.cross(ab);
  const double u = to.dot(p), v = direction.dot(q), distance = ac.dot(q) / determinant;
  if (u < 0.0 || v < 0.0 || u + v > determinant || distance < 0.0 || distance > length) return {};
  return distance;
}

}  // namespace lodestone
