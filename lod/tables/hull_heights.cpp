#include "lod/tables/hull_heights.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lodestone {
namespace {

// Of a pair's reach, the part of the way from the support height, at which two hulls are surely apart, to
// where the line of centres leaves the hull, at which two faces meet; and the power of the part of its hull
// that a concave shape fills. Both so that piles of boxes, L-shapes and bunnies are as high as ODE's.
constexpr double kInward = 0.35, kHollow = 1.0 / 3.0;
constexpr double kRolling = 0.2;  // that piles come to rest when ODE's do

Vec3 direction_at(int column, int row) {
  const double x = 2.0 * column / kHullHeightSide - 1.0, y = 2.0 * row / kHullHeightSide - 1.0,
               z = 1.0 - std::abs(x) - std::abs(y);
  if (z >= 0.0) return Vec3(x, y, z).normalized();
  return Vec3(std::copysign(1.0 - std::abs(y), x), std::copysign(1.0 - std::abs(x), y), z).normalized();
}

// m, to where a ray from the centre of mass leaves the hull.
double find_way_out(const Hull& hull, const Vec3& direction) {
  double way = std::numeric_limits<double>::infinity();
  for (std::size_t face = 0; face < hull.faces.size(); ++face) {
    const Vec3 normal = hull.face_normal(int(face));
    const double along = normal.dot(direction);
    if (along > 0.0) way = std::min(way, normal.dot(hull.vertices[std::size_t(hull.faces[face][0])]) / along);
  }
  return way;
}

double volume_of(const Hull& hull) {
  double six_volumes = 0.0;
  for (std::size_t face = 0; face < hull.faces.size(); ++face)
    six_volumes += hull.face_normal(int(face)).dot(hull.vertices[std::size_t(hull.faces[face][0])]);
  return six_volumes / 6.0;
}

}  // namespace

double find_rolling_lever(const Shape& shape) {
  if (shape.sphere_radius) return 0.0;
  double sum = 0.0, solid_angles = 0.0;
  int vertex = 0;
  for (int row = 0; row <= kHullHeightSide; ++row)
    for (int column = 0; column <= kHullHeightSide; ++column) {
      const Vec3 direction = direction_at(column, row);
      vertex = find_support(shape.hull, direction, vertex);
      const double solid_angle = std::pow(direction.lpNorm<1>(), 3.0);  // of the map's equal squares
      sum += solid_angle * direction.cross(shape.hull.vertices[std::size_t(vertex)]).norm();
      solid_angles += solid_angle;
    }
  return kRolling * sum / solid_angles;
}

void sample_hull_heights(const Shape& shape, std::span<float> heights, std::span<float> reaches) {
  if (shape.sphere_radius) {
    std::ranges::fill(heights, float(*shape.sphere_radius));
    std::ranges::fill(reaches, float(*shape.sphere_radius));
    return;
  }
  const Hull& hull = shape.hull;
  const double solid = std::pow(std::min(1.0, shape.volume / volume_of(hull)), kHollow);
  int vertex = 0;  // each climb begins where the last one ended
  std::size_t at = 0;
  for (int row = 0; row <= kHullHeightSide; ++row)
    for (int column = 0; column <= kHullHeightSide; ++column, ++at) {
      const Vec3 direction = direction_at(column, row);
      vertex = find_support(hull, direction, vertex);
      const double height = hull.vertices[std::size_t(vertex)].dot(direction);
      heights[at] = float(height);
      const double way_out = std::min(height, find_way_out(hull, direction));
      reaches[at] = float(solid * (height + kInward * (way_out - height)));
    }
}

}  // namespace lodestone
