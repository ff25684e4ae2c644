#include "lod/ground/deep_triangles.h"

#include <algorithm>

namespace lodestone {
namespace {

using Floats = std::array<float, 3>;

Floats floats_of(const Vec3& v) { return {float(v[0]), float(v[1]), float(v[2])}; }

float dot(const Floats& a, const Floats& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

float squared_distance(const FloatBox& box, const Floats& point) {
  float square = 0.0f;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float beside = std::max({0.0f, box.least[axis] - point[axis], point[axis] - box.greatest[axis]});
    square += beside * beside;
  }
  return square;
}

// Of its points, along `way`.
float greatest_along(const FloatBox& box, const Floats& way) {
  float sum = 0.0f;
  for (std::size_t axis = 0; axis < 3; ++axis)
    sum += std::max(way[axis] * box.least[axis], way[axis] * box.greatest[axis]);
  return sum;
}

}  // namespace

DeepTriangles::DeepTriangles(std::span<const Corners> triangles, double depth,
                             const std::optional<OneWay>& one_way)
    : depth_(float(depth)), one_way_(one_way.has_value()) {
  std::vector<Vec3> normals;
  std::vector<Eigen::AlignedBox3d> bare, deep;
  Eigen::AlignedBox3d all;
  for (const Corners& corner : triangles)
    for (const Vec3& c : corner) all.extend(c);
  if (!all.isEmpty()) middle_ = all.center();
  for (const Corners& corner : triangles) {
    normals.push_back((corner[1] - corner[0]).cross(corner[2] - corner[0]).normalized());
    Eigen::AlignedBox3d& box = bare.emplace_back();
    for (const Vec3& c : corner) box.extend(c - middle_);
    deep.push_back(box), deep.back().extend(box.translated(-depth * normals.back()));
    bounds_.extend(deep.back().translated(middle_));
  }
  if (one_way) up_ = floats_of(one_way->up), deepest_over_height_ = float(1.0 / one_way->least_cosine);
  tree_ = BoxHierarchy(one_way ? bare : deep);
  flats_.reserve(triangles.size());
  for (std::size_t place = 0; place < triangles.size(); ++place) {
    const auto i = std::size_t(tree_.number_at(std::int32_t(place)));
    flats_.push_back({floats_of(normals[i]),
                      float(normals[i].dot(triangles[i][0] - middle_)),
                      {floats_of(bare[i].min()), floats_of(bare[i].max())}});
  }
}

// To what is over its plane the triangle itself is nearest, to what is below it what is straight above.
bool DeepTriangles::is_near(const Flat& t, const Floats& center, float reach) const {
  const float height = dot(t.normal, center) - t.offset;
  if (height > reach || -height > depth_ + reach) return false;
  const float up = std::max(0.0f, -height);
  const Floats nearest{center[0] + up * t.normal[0], center[1] + up * t.normal[1],
                       center[2] + up * t.normal[2]};
  return squared_distance(t.box, nearest) <= reach * reach;
}

// What lies a depth below a point of a triangle is lower than that by `least_cosine` of the depth or more: to
// come down to the ball it need not be deeper than so.
bool DeepTriangles::may_be_near(const FloatBox& bare, const Floats& center, float reach) const {
  const float over_bottom = greatest_along(bare, up_) - dot(up_, center) + reach;
  if (over_bottom < 0.0f) return false;
  const float way = reach + std::min(depth_, deepest_over_height_ * over_bottom);
  return squared_distance(bare, center) <= way * way;
}

void DeepTriangles::find_near(const Vec3& around, double within, int first, std::vector<int>& found) const {
  constexpr float kRounding = 1e-6f;  // more than a float errs by in some sums
  const Vec3 from_middle = around - middle_;
  const Floats center = floats_of(from_middle);
  const Vec3 largest = bounds_.sizes() + from_middle.cwiseAbs();
  const float reach = float(within) + kRounding * float(largest.sum() + within);
  const auto add = [&](std::int32_t place) {
    if (is_near(flats_[std::size_t(place)], center, reach)) found.push_back(first + tree_.number_at(place));
  };
  if (one_way_)
    tree_.visit_places([&](const FloatBox& box) { return may_be_near(box, center, reach); }, add);
  else
    tree_.visit_places([&](const FloatBox& box) { return squared_distance(box, center) <= reach * reach; },
                       add);
}

}  // namespace lodestone
