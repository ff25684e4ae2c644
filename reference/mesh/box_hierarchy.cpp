#include "reference/mesh/box_hierarchy.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace lodestone {
namespace {

constexpr std::int32_t kLeaf = 4;  // boxes

float at_most(double x) {
  const auto near = float(x);
  return double(near) > x ? std::nextafter(near, -std::numeric_limits<float>::infinity()) : near;
}

FloatBox around(const Eigen::AlignedBox3d& box) {
  FloatBox larger;
  for (int axis = 0; axis < 3; ++axis) {
    larger.least[std::size_t(axis)] = at_most(box.min()[axis]);
    larger.greatest[std::size_t(axis)] = -at_most(-box.max()[axis]);
  }
  return larger;
}

}  // namespace

BoxHierarchy::BoxHierarchy(std::span<const Box> boxes) : numbers_(boxes.size()) {
  if (boxes.empty()) return;
  std::iota(numbers_.begin(), numbers_.end(), 0);
  nodes_.reserve(boxes.size());
  nodes_.push_back({.first = 0, .count = std::int32_t(boxes.size())});
  for (std::size_t node = 0; node < nodes_.size(); ++node) split(node, boxes);
}

// At the median of their middles, along the longest side of what they hold together.
void BoxHierarchy::split(std::size_t index, std::span<const Box> boxes) {
  const std::int32_t first = nodes_[index].first, count = nodes_[index].count;
  const auto begin = numbers_.begin() + first, end = begin + count;
  Box all;
  std::for_each(begin, end, [&](std::int32_t i) { all.extend(boxes[std::size_t(i)]); });
  nodes_[index].box = around(all);
  if (count <= kLeaf) return;
  int axis = 0;
  all.sizes().maxCoeff(&axis);
  const auto twice_middle = [&](std::int32_t i) {  // a number, of boxes without end, too
    constexpr double kMost = std::numeric_limits<float>::max();
    const Box& box = boxes[std::size_t(i)];
    return std::max(-kMost, box.min()[axis]) + std::min(kMost, box.max()[axis]);
  };
  const std::int32_t half = count / 2;
  std::nth_element(begin, begin + half, end,
                   [&](std::int32_t a, std::int32_t b) { return twice_middle(a) < twice_middle(b); });
  nodes_[index].first = std::int32_t(nodes_.size()), nodes_[index].count = 0;
  nodes_.push_back({.first = first, .count = half});
  nodes_.push_back({.first = first + half, .count = count - half});
}

}  // namespace lodestone
