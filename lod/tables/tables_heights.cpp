// Of TablesLevel: how far its bodies reach, towards the ground and towards each other.
#include "lod/tables/hull_separation.h"
#include "lod/tables/tables_level.h"

namespace lodestone {

/// m, from the centre of mass: what stands for the body towards the ground, and towards others.
float TablesLevel::ground_height(std::int64_t place, const Vec3& direction) const {
  return constants_.hulls ? read_heights(kinds_.hull_height, place, direction)
                          : spheres_.radius[std::size_t(place)];
}

/// Whether a face on which it stands firmly lies on a plane that is in that direction (unit).
bool TablesLevel::lies_flush(std::int64_t place, const Vec3& direction) const {
  const Vec3 own = spheres_.orientation(place).conjugate() * direction;
  const lane::F3 towards{float(own.x()), float(own.y()), float(own.z())};
  const std::size_t at = std::size_t(int(spheres_.kind[std::size_t(place)]) * kHullHeights +
                                     lane::place_in_map(towards).nearest);
  const lane::Row& face = kinds_.pair_face[at];
  return dot({face.x, face.y, face.z}, towards) > lane::kFlushCosine + kinds_.unsteady[at];
}

/// m: where a line in that direction (unit) from its centre leaves it.
double TablesLevel::exit_distance(std::int64_t place, const Vec3& direction) const {
  const auto i = std::size_t(place);
  if (!constants_.hulls) return double(spheres_.radius[i]);
  const Vec3 own = spheres_.orientation(place).conjugate() * direction;
  const lane::MapPlace at = lane::place_in_map({float(own.x()), float(own.y()), float(own.z())});
  const lane::Row& face = kinds_.pair_face[std::size_t(int(spheres_.kind[i]) * kHullHeights + at.nearest)];
  const double cosine = Vec3(double(face.x), double(face.y), double(face.z)).dot(own);
  return cosine > 0.0 ? double(face.w) / cosine : double(face.w);
}

/// On the line of their centres, midway between where it leaves the one and the other: on or in both.
Vec3 TablesLevel::meeting_point(std::int64_t first, std::int64_t second) const {
  const Vec3 from = spheres_.position(second), between = spheres_.position(first) - from;
  const double distance = between.norm();
  if (distance < 1e-12) return from;
  const Vec3 line = between / distance;
  return from + 0.5 * (exit_distance(second, line) + distance - exit_distance(first, -line)) * line;
}

float TablesLevel::read_heights(const std::vector<float>& heights, std::int64_t place,
                                const Vec3& direction) const {
  const Vec3 own = spheres_.orientation(place).conjugate() * direction;
  return read_hull_height(heights.data(), int(spheres_.kind[std::size_t(place)]) * kHullHeights,
                          {float(own.x()), float(own.y()), float(own.z())});
}

/// The way from the second to the first along which they are apart the most, and how far, m.
std::pair<Vec3, double> TablesLevel::separate(std::int64_t first, std::int64_t second) const {
  const Vec3 between = spheres_.position(first) - spheres_.position(second);
  const double distance = between.norm();
  const Vec3 along = distance > 1e-12 ? Vec3(between / distance) : Vec3(Vec3::UnitZ());
  if (!constants_.hulls)
    return {along, distance - double(spheres_.radius[std::size_t(first)]) -
                       double(spheres_.radius[std::size_t(second)])};
  const auto placed = [&](std::int64_t place) {
    const std::size_t i = std::size_t(place);
    return lane::MappedHull{int(spheres_.kind[i]) * kHullHeights,
                            {spheres_.qw[i], {spheres_.qx[i], spheres_.qy[i], spheres_.qz[i]}}};
  };
  const float* heights = kinds_.pair_height.data();
  const lane::MappedHull one = placed(first), other = placed(second);
  const lane::F3 line{float(along.x()), float(along.y()), float(along.z())};
  const float per_gravity = -1.0f / std::max(constants_.gravity, 1e-30f);
  const lane::F3 up{constants_.gx * per_gravity, constants_.gy * per_gravity, constants_.gz * per_gravity};
  const lane::HullSeparation found = lane::separate_hulls(
      heights, kinds_.pair_face.data(), kinds_.unsteady.data(), one, other, line, float(distance),
      lane::separate_along_line(heights, one, other, line, float(distance)), {up, {}, 0.0f});
  return {Vec3(double(found.normal.x), double(found.normal.y), double(found.normal.z)), double(found.gap)};
}

}  // namespace lodestone
