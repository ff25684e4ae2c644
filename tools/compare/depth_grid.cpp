#include "tools/compare/depth_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "reference/mesh/inside.h"

namespace lodestone {
namespace {

struct Triangle {
  Vec3 a, b, c, middle;
  double reach;  // m, of its corners from the middle
};

std::vector<Triangle> triangles_of(const Mesh& mesh) {
  std::vector<Triangle> triangles;
  for (const auto& face : mesh.faces) {
    Triangle t{mesh.vertices[std::size_t(face[0])],
               mesh.vertices[std::size_t(face[1])],
               mesh.vertices[std::size_t(face[2])],
               {},
               0.0};
    t.middle = (t.a + t.b + t.c) / 3.0;
    t.reach = std::max({(t.a - t.middle).norm(), (t.b - t.middle).norm(), (t.c - t.middle).norm()});
    triangles.push_back(t);
  }
  return triangles;
}

double distance_to_edge(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 ab = b - a;
  const double t = std::clamp((p - a).dot(ab) / std::max(1e-300, ab.squaredNorm()), 0.0, 1.0);
  return (p - a - t * ab).norm();
}

double distance_to(const Triangle& t, const Vec3& p) {
  const Vec3 normal = (t.b - t.a).cross(t.c - t.a);
  const auto is_left_of = [&](const Vec3& a, const Vec3& b) {
    return normal.dot((b - a).cross(p - a)) >= 0.0;
  };
  if (is_left_of(t.a, t.b) && is_left_of(t.b, t.c) && is_left_of(t.c, t.a) && normal.squaredNorm() > 0.0)
    return std::abs(normal.dot(p - t.a)) / normal.norm();
  return std::min(
      {distance_to_edge(p, t.a, t.b), distance_to_edge(p, t.b, t.c), distance_to_edge(p, t.c, t.a)});
}

double distance_to(const std::vector<Triangle>& triangles, const Vec3& p) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Triangle& t : triangles) {
    const double bound = nearest + t.reach;
    if ((p - t.middle).squaredNorm() < bound * bound) nearest = std::min(nearest, distance_to(t, p));
  }
  return nearest;
}

}  // namespace

DepthGrid::DepthGrid(const Mesh& mesh, int cells) {
  Vec3 low = mesh.vertices.front(), high = low;
  for (const Vec3& v : mesh.vertices) low = low.cwiseMin(v), high = high.cwiseMax(v);
  cell_ = (high - low).maxCoeff() / cells;
  low_ = low - Vec3::Constant(1.01 * cell_);
  count_ = (((high - low) / cell_).array().ceil() + 4.0).cast<int>();
  depths_.resize(std::size_t(count_.prod()));
  const std::vector<Triangle> triangles = triangles_of(mesh);
  for (int z = 0; z < count_.z(); ++z)
    for (int y = 0; y < count_.y(); ++y)
      for (int x = 0; x < count_.x(); ++x) {
        const Vec3 node = low_ + cell_ * Vec3(x, y, z);
        const double distance = distance_to(triangles, node);
        at(x, y, z) = winding_number(mesh, node) > 0 ? distance : -distance;
      }
}

double DepthGrid::depth(const Vec3& point) const {
  const Vec3 place = (point - low_) / cell_;
  const Eigen::Vector3i node = place.array().floor().cast<int>();
  if ((node.array() < 0).any() || (node.array() + 1 >= count_.array()).any())
    return -std::numeric_limits<double>::infinity();
  const Vec3 t = place - node.cast<double>();
  double depth = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const int x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
    depth += (x ? t.x() : 1.0 - t.x()) * (y ? t.y() : 1.0 - t.y()) * (z ? t.z() : 1.0 - t.z()) *
             at(node.x() + x, node.y() + y, node.z() + z);
  }
  return depth;
}

}  // namespace lodestone
