#include "lod/tables/hull_heights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "reference/mesh/mass_properties.h"

namespace lodestone {
namespace {

// Of its hull's size, the least as which others meet a concave shape, whatever of its hull it fills.
constexpr double kLeastSolid = 0.84;

Vec3 direction_at(int column, int row) {
  const double x = 2.0 * column / kHullHeightSide - 1.0, y = 2.0 * row / kHullHeightSide - 1.0,
               z = 1.0 - std::abs(x) - std::abs(y);
  if (z >= 0.0) return Vec3(x, y, z).normalized();
  return Vec3(std::copysign(1.0 - std::abs(y), x), std::copysign(1.0 - std::abs(x), y), z).normalized();
}

// The plane, normal and distance, of the face through which a ray from the centre of mass leaves it.
lane::Row find_way_out(const Hull& hull, const Vec3& direction) {
  double way = std::numeric_limits<double>::infinity(), distance = 0.0;
  Vec3 out = direction;
  for (std::size_t face = 0; face < hull.faces.size(); ++face) {
    const Vec3 normal = hull.face_normals[face];
    const double along = normal.dot(direction),
                 offset = normal.dot(hull.vertices[std::size_t(hull.faces[face][0])]);
    if (along > 0.0 && offset / along < way) way = offset / along, distance = offset, out = normal;
  }
  return {float(out.x()), float(out.y()), float(out.z()), float(distance)};
}

// Over its hull's, the size as which others meet it, who reach into its hollows: that of a solid of its
// volume, larger where its mass lies farther out than its hull's does, as that of rings and frames. So piles
// are about as high as those of meshes.
double find_solid_size(const Shape& shape) {
  if (shape.sphere_radius || shape.convex) return 1.0;
  const MassProperties hull = measure_mass_properties({shape.hull.vertices, shape.hull.faces});
  const double as_volume = std::cbrt(std::min(1.0, shape.volume / hull.volume)),
               mass_out = std::sqrt(shape.inertia_per_mass.trace() / hull.inertia_per_mass.trace());
  return std::clamp(as_volume * std::max(1.0, mass_out), kLeastSolid, 1.0);
}

SupportPatch find_patch_of(const Hull& hull, const Vec3& direction, int start) {
  // Looks along each of two directions aside: an even number, so that none is along the direction itself, for
  // which all corners of a face are equally far.
  constexpr int kAlong = 6;
  const Vec3 u = direction.unitOrthogonal(), v = direction.cross(u);
  Vec3 mean = Vec3::Zero();
  Mat3 square = Mat3::Zero();
  for (int i = 0; i < kAlong; ++i)
    for (int k = 0; k < kAlong; ++k) {
      const double by_u = 2.0 * (i + 0.5) / kAlong - 1.0, by_v = 2.0 * (k + 0.5) / kAlong - 1.0;
      const Vec3 aside = double(kPatchAngle) * (by_u * u + by_v * v);
      const Vec3& point = hull.vertices[std::size_t(find_support(hull, direction + aside, start))];
      mean += point / (kAlong * kAlong);
      square += point * point.transpose() / (kAlong * kAlong);
    }
  square -= mean * mean.transpose();
  return {{float(mean.x()), float(mean.y()), float(mean.z())},
          float(square(0, 0)),
          float(square(1, 1)),
          float(square(2, 2)),
          float(square(0, 1)),
          float(square(0, 2)),
          float(square(1, 2))};
}

}  // namespace

void find_unsteady(const RestingFaces* stands, std::span<const lane::Row> faces, std::span<float> unsteady) {
  constexpr double kSameFace = 0.998;  // cosine
  constexpr double kFirmly = 0.3;      // tangent of the angle
  constexpr int kAround = 8;
  std::vector<Vec3> firm;  // normals, out of the body
  if (stands)
    for (const RestingFace& face : stands->faces()) {
      const Vec3 out = -face.normal, u = out.unitOrthogonal(), v = out.cross(u);
      bool holds = true;
      for (int i = 0; i < kAround; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / kAround;
        holds =
            holds && stands->holds(face.normal, out + kFirmly * (std::cos(angle) * u + std::sin(angle) * v));
      }
      if (holds) firm.push_back(out);
    }
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const Vec3 normal(double(faces[i].x), double(faces[i].y), double(faces[i].z));
    const bool is_firm = std::ranges::any_of(firm, [&](const Vec3& f) { return f.dot(normal) > kSameFace; });
    unsteady[i] = is_firm ? 0.0f : 1.0f;
  }
}

Mat3 find_rolling_levers(const Shape& shape) {
  if (shape.sphere_radius) return Mat3::Zero();
  double sum = 0.0, solid_angles = 0.0;
  Mat3 squares = Mat3::Zero();
  int vertex = 0;
  for (int row = 0; row <= kHullHeightSide; ++row)
    for (int column = 0; column <= kHullHeightSide; ++column) {
      const Vec3 direction = direction_at(column, row);
      vertex = find_support(shape.hull, direction, vertex);
      const double solid_angle = std::pow(direction.lpNorm<1>(), 3.0);  // of the map's equal squares
      const Vec3 lever = direction.cross(shape.hull.vertices[std::size_t(vertex)]);
      sum += solid_angle * lever.norm();
      squares += solid_angle * lever * lever.transpose();
      solid_angles += solid_angle;
    }
  const double mean = kRollingShare * sum / solid_angles;
  return 3.0 * mean * mean / squares.trace() * squares;
}

void sample_hull(const Shape& shape, const HullMaps& maps) {
  const double solid = find_solid_size(shape);
  int vertex = 0;  // each climb begins where the last one ended
  std::size_t at = 0;
  for (int row = 0; row <= kHullHeightSide; ++row)
    for (int column = 0; column <= kHullHeightSide; ++column, ++at) {
      const Vec3 direction = direction_at(column, row);
      lane::Row& face = maps.pair_face[at];
      if (shape.sphere_radius) {
        maps.height[at] = float(*shape.sphere_radius);
        face = {float(direction.x()), float(direction.y()), float(direction.z()),
                float(*shape.sphere_radius)};
        maps.patch[at] = {.mean = maps.height[at] * lane::F3{face.x, face.y, face.z}};
      } else {
        vertex = find_support(shape.hull, direction, vertex);
        maps.height[at] = float(shape.hull.vertices[std::size_t(vertex)].dot(direction));
        face = find_way_out(shape.hull, direction);
        face.w = float(solid * double(face.w));
        maps.patch[at] = find_patch_of(shape.hull, direction, vertex);
      }
      maps.pair_height[at] = float(solid * double(maps.height[at]));
    }
}

}  // namespace lodestone
