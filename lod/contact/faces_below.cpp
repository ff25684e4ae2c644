#include "lod/contact/faces_below.h"

#include <algorithm>
#include <limits>

namespace lodestone {

Vec3 in_part(const PlacedSolid& placed, const Vec3& point) {
  return placed.orientation.conjugate() * (point - placed.position) + placed.solid->center;
}

bool is_over(const SurfaceTriangle& t, const Vec3& point, double rounding) {
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 along = t.corner[(i + 1) % 3] - t.corner[i];
    if (t.normal.cross(along).dot(point - t.corner[i]) < -rounding * along.norm()) return false;
  }
  return true;
}

bool is_behind(const SurfaceTriangle& t, const Vec3& point) {
  const double height = t.normal.dot(point - t.corner[0]);
  if (height >= 0.0) return false;
  double sum = 0.0, thickness = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {  // by the point's shares of the corners
    const Vec3 &b = t.corner[(i + 1) % 3], &c = t.corner[(i + 2) % 3];
    const double share = std::max(0.0, (b - point).cross(c - point).dot(t.normal));
    sum += share, thickness += share * t.thickness[i];
  }
  return -height * sum > thickness;
}

Vec3 find_way_from_edge(const SurfaceTriangle& t, std::size_t edge, const Vec3& point) {
  const Vec3 from = point - t.corner[edge], along = t.corner[(edge + 1) % 3] - t.corner[edge];
  return from - std::clamp(from.dot(along) / along.squaredNorm(), 0.0, 1.0) * along;
}

std::optional<HalfSpace> find_face_below(const PlacedSolid& placed, const Vec3& center, double reach) {
  const GroundSolid& solid = *placed.solid;
  if (solid.surface || solid.faces.empty())
    return {};  // its neighbours may rise beside it; a sphere has no face
  const Vec3 in_solid = placed.orientation.conjugate() * (center - placed.position);
  std::optional<HalfSpace> face;
  for (const auto& [normal, offset] : solid.faces) {
    const double height = normal.dot(in_solid) - offset;
    if (height <= -reach) continue;
    if (height < 0.0 || face) return {};
    const Vec3 up = placed.orientation * normal;
    face = HalfSpace{up, offset + up.dot(placed.position), placed.part->material, placed.part->id};
  }
  return face;
}

SurfaceBelow find_surface_below(const PlacedSolid& placed, const Vec3& center, double reach) {
  const SurfaceTriangle& t = *placed.solid->surface;
  const Vec3 at = in_part(placed, center);
  const double height = t.normal.dot(at - t.corner[0]);
  if (std::abs(height) >= reach) return {};
  bool ridge = false, any_edge = false;
  for (std::size_t i = 0; i < 3; ++i) {
    const bool in_reach = find_way_from_edge(t, i, at).squaredNorm() < reach * reach;
    any_edge |= in_reach;
    ridge |= in_reach && t.ridge[i];
  }
  if (!any_edge && !is_over(t, at)) return {};
  if (!ridge && is_behind(t, at)) return {};
  if (ridge || height < 0.0) return {.in_reach = true, .plane = {}};
  const Vec3 normal = placed.orientation * t.normal,
             corner = placed.position + placed.orientation * (t.corner[0] - placed.solid->center);
  return {.in_reach = true,
          .plane = HalfSpace{normal, normal.dot(corner), placed.part->material, placed.part->id}};
}

bool find_faces_below(std::span<const PlacedSolid> near, const Vec3& center, double radius, double reach,
                      std::vector<HalfSpace>& planes) {
  constexpr std::size_t kMostOfSurfaces = 2;
  const std::size_t before = planes.size();
  std::size_t of_surfaces = 0;
  const auto differ = [&](const HalfSpace& a, const HalfSpace& b) {  // anywhere in reach, by what shows
    return a.id != b.id || a.material != b.material ||
           (a.normal - b.normal).norm() * reach + std::abs(a.height_of(center) - b.height_of(center)) >
               1e-4 * radius;
  };
  const auto add = [&](const PlacedSolid& solid) {
    if (!solid.solid->surface) {
      const auto face = find_face_below(solid, center, reach);
      if (face) planes.push_back(*face);
      return face.has_value();
    }
    const SurfaceBelow below = find_surface_below(solid, center, reach);
    if (!below.plane) return !below.in_reach;
    const auto known = std::span(planes).subspan(before);
    if (!std::ranges::all_of(known, [&](const HalfSpace& other) { return differ(*below.plane, other); }))
      return true;
    planes.push_back(*below.plane);
    return ++of_surfaces <= kMostOfSurfaces;
  };
  if (std::ranges::all_of(near, add)) return true;
  planes.resize(before);
  return false;
}

namespace {

Vec3 find_nearest_on(const SurfaceTriangle& t, const Vec3& at) {
  Vec3 nearest = at - t.normal.dot(at - t.corner[0]) * t.normal;
  double least = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 from = at - t.corner[i], along = t.corner[(i + 1) % 3] - t.corner[i];
    if (t.normal.cross(along).dot(from) >= 0.0) continue;
    const Vec3 on_edge = t.corner[i] + std::clamp(from.dot(along) / along.squaredNorm(), 0.0, 1.0) * along;
    const double distance = (at - on_edge).squaredNorm();
    if (distance < least) least = distance, nearest = on_edge;
  }
  return nearest;
}

}  // namespace

bool is_smooth(std::span<const PlacedSolid> near, const Vec3& center, double reach) {
  return std::ranges::all_of(near, [&](const PlacedSolid& solid) {
    if (!solid.solid->surface) return false;
    const SurfaceBelow below = find_surface_below(solid, center, reach);
    return !below.in_reach || below.plane;
  });
}

std::optional<HalfSpace> find_mean_plane(std::span<const PlacedSolid> near, const Vec3& center, double reach,
                                         double least_cosine) {
  constexpr double kSeam = 1e-12;  // over the square of the reach: nearer than so it lies over the triangle
  constexpr double kLayer = 1e-3;  // over the reach: so far below another it is hidden
  struct Over {
    Vec3 normal, foot;
  };
  thread_local std::vector<Vec3> normals;
  thread_local std::vector<Over> over;  // triangles, and the point of each that is straight below
  normals.clear(), over.clear();
  const auto hides = [&](const Over& one, const Over& other) {
    return one.normal.dot(other.foot - one.foot) < -kLayer * reach;
  };
  HalfSpace mean{.normal = Vec3::Zero()};
  Vec3 place = Vec3::Zero();
  double weights = 0.0;
  for (const PlacedSolid& placed : near) {
    if (!placed.solid->surface) return {};
    const SurfaceTriangle& t = *placed.solid->surface;
    const Vec3 at = in_part(placed, center);
    if (is_behind(t, at)) continue;
    const Vec3 way = placed.orientation * (at - find_nearest_on(t, at));
    const double share = way.squaredNorm() / (reach * reach);
    if (share >= 1.0) continue;
    normals.push_back(placed.orientation * t.normal);
    const double height = normals.back().dot(way);
    if (height < 0.0) return {};
    const double weight = (1.0 - share) * (1.0 - share);
    weights += weight;
    mean.normal += weight * normals.back();
    place += weight * (center - way);
    if (way.squaredNorm() - height * height > kSeam * reach * reach) continue;
    const Over own{normals.back(), center - way};
    for (const Over& other : over)
      if (hides(own, other) || hides(other, own)) return {};
    over.push_back(own);
    mean.material = placed.part->material, mean.id = placed.part->id;
  }
  if (over.empty()) return {};
  mean.normal.normalize();
  mean.offset = mean.normal.dot(place) / weights;
  const auto is_gentle = [&](const Vec3& normal) { return normal.dot(mean.normal) > least_cosine; };
  if (!std::ranges::all_of(normals, is_gentle)) return {};
  return mean;
}

}  // namespace lodestone
