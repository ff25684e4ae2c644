#include "reference/hull/tip_map.h"

namespace lodestone {
namespace {

constexpr int kSide = 16;                      // cells along a face of the cube
constexpr std::size_t kFewVertices = 64;       // of a hull
constexpr std::size_t kMostVertices = 65'536;  // that have a number here

}  // namespace

// A vertex v lies (w − v)·d short of w along d, which for any d that is `reach` from the middle m of a cell
// is at least (w − v)·m − |w − v| reach.
TipMap::TipMap(const Hull& hull, double radius) {
  const std::size_t count = hull.vertices.size();
  if (count < kFewVertices || count > kMostVertices) return;
  cells_ = CubeMap(kSide);
  first_.push_back(0);
  int farthest = 0;
  for (int cell = 0; cell < cells_.size(); ++cell) {
    const Vec3 middle = cells_.middle_of(cell).normalized();
    const double reach = cells_.find_reach(cell);
    farthest = find_support(hull, middle, farthest);
    const Vec3& tip = hull.vertices[std::size_t(farthest)];
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 to_tip = tip - hull.vertices[i];
      if (to_tip.dot(middle) - to_tip.norm() * reach <= kDepth * radius)
        vertices_.push_back(std::uint16_t(i));
    }
    if (vertices_.size() - first_.back() > kMost) vertices_.resize(first_.back());
    first_.push_back(std::uint32_t(vertices_.size()));
  }
  vertices_.shrink_to_fit();
}

}  // namespace lodestone
