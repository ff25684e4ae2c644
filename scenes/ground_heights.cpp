#include "scenes/ground_heights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "scenes/terrain.h"

namespace lodestone {
namespace {

/// Twice the area of a triangle in the horizontal plane, positive counter-clockwise.
double turn_of(const Vec3& a, const Vec3& b, double x, double y) {
  return (b.x() - a.x()) * (y - a.y()) - (b.y() - a.y()) * (x - a.x());
}

std::optional<double> height_of_face(const Vec3& a, const Vec3& b, const Vec3& c, double x, double y) {
  const double area = turn_of(a, b, c.x(), c.y());
  if (area == 0) return std::nullopt;  // upright
  const double of_a = turn_of(b, c, x, y) / area, of_b = turn_of(c, a, x, y) / area, of_c = 1 - of_a - of_b;
  constexpr double kEdge = -1e-9;  // what is between two faces belongs to both
  if (of_a < kEdge || of_b < kEdge || of_c < kEdge) return std::nullopt;
  return of_a * a.z() + of_b * b.z() + of_c * c.z();
}

void keep_higher(std::optional<double>& highest, std::optional<double> height) {
  if (height && (!highest || *height > *highest)) highest = height;
}

}  // namespace

GroundHeights::Grid::Grid(const Mesh& of) : mesh(of), faces(kCells * kCells) {
  for (const Vec3& vertex : mesh.vertices) bounds.extend(vertex);
  for (int face = 0; face < int(mesh.faces.size()); ++face) {
    Eigen::AlignedBox3d around;
    for (const int corner : mesh.faces[std::size_t(face)]) around.extend(mesh.vertices[std::size_t(corner)]);
    const std::array<int, 2> low = cell_of(around.min().x(), around.min().y()),
                             high = cell_of(around.max().x(), around.max().y());
    for (int row = low[1]; row <= high[1]; ++row)
      for (int column = low[0]; column <= high[0]; ++column)
        faces[std::size_t(row * kCells + column)].push_back(face);
  }
}

std::array<int, 2> GroundHeights::Grid::cell_of(double x, double y) const {
  const Vec3 size = bounds.sizes();
  const auto along = [](double from, double length) {
    return length > 0 ? std::clamp(int(kCells * (from / length)), 0, kCells - 1) : 0;
  };
  return {along(x - bounds.min().x(), size.x()), along(y - bounds.min().y(), size.y())};
}

std::optional<double> GroundHeights::Grid::height_at(double x, double y) const {
  std::optional<double> highest;
  if (x < bounds.min().x() || x > bounds.max().x() || y < bounds.min().y() || y > bounds.max().y())
    return highest;
  const std::array<int, 2> cell = cell_of(x, y);
  for (const int face : faces[std::size_t(cell[1] * kCells + cell[0])]) {
    const auto& f = mesh.faces[std::size_t(face)];
    keep_higher(highest, height_of_face(mesh.vertices[std::size_t(f[0])], mesh.vertices[std::size_t(f[1])],
                                        mesh.vertices[std::size_t(f[2])], x, y));
  }
  return highest;
}

GroundHeights::GroundHeights(std::span<const SceneGround> ground) {
  for (const SceneGround& part : ground) {
    if (const auto* plane = std::get_if<GroundPlane>(&part))
      planes_.push_back(*plane);
    else if (const auto* box = std::get_if<GroundBox>(&part))
      grids_.emplace_back(make_ground_mesh(*box));
    else
      grids_.emplace_back(std::get<GroundMesh>(part).mesh);
  }
}

std::optional<double> GroundHeights::height_at(double x, double y) const {
  std::optional<double> highest;
  for (const GroundPlane& plane : planes_)
    if (plane.normal.z() > 1e-9)
      keep_higher(highest, (plane.offset_m - plane.normal.x() * x - plane.normal.y() * y) / plane.normal.z());
  for (const Grid& grid : grids_) keep_higher(highest, grid.height_at(x, y));
  return highest;
}

std::optional<double> GroundHeights::highest_under(const Vec3& center, double radius) const {
  std::optional<double> highest = height_at(center.x(), center.y());
  for (const double r : {0.5 * radius, radius})
    for (int i = 0; i < 8; ++i) {
      const double angle = i * std::numbers::pi / 4;
      keep_higher(highest, height_at(center.x() + r * std::cos(angle), center.y() + r * std::sin(angle)));
    }
  return highest;
}

std::optional<RigidState> GroundHeights::lay(const Shape& shape, const Quat& orientation, double turn_rad,
                                             const Vec3& center) const {
  const double reach = 0.5 * shape.radius;
  const auto west = height_at(center.x() - reach, center.y()),
             east = height_at(center.x() + reach, center.y());
  const auto south = height_at(center.x(), center.y() - reach),
             north = height_at(center.x(), center.y() + reach);
  if (!west || !east || !south || !north) return std::nullopt;
  const Vec3 normal = Vec3(*west - *east, *south - *north, 2 * reach).normalized();
  const double middle = height_at(center.x(), center.y()).value_or(*west);
  for (int i = 0; i < 16; ++i) {  // on an edge, it would tip over or the edge would be in it
    constexpr double kUneven = 0.1;
    const double r = (i % 2 ? 1.0 : 0.5) * shape.radius, x = r * std::cos(i / 2 * std::numbers::pi / 4),
                 y = r * std::sin(i / 2 * std::numbers::pi / 4);
    const std::optional<double> ground = height_at(center.x() + x, center.y() + y);
    if (!ground || std::abs(normal.dot(Vec3(x, y, *ground - middle))) > kUneven * shape.radius)
      return std::nullopt;
  }
  RigidState state{.position = center};
  state.orientation = rotation_between(Vec3::UnitZ(), normal) *
                      Quat(Eigen::AngleAxisd(turn_rad, Vec3::UnitZ())) * orientation;
  state.position.z() = -std::numeric_limits<double>::infinity();
  for (const Vec3& vertex : shape.hull.vertices) {
    const Vec3 from_middle = state.orientation * vertex;
    const std::optional<double> ground =
        height_at(center.x() + from_middle.x(), center.y() + from_middle.y());
    if (!ground) return std::nullopt;
    state.position.z() = std::max(state.position.z(), *ground - from_middle.z());
  }
  return state;
}

}  // namespace lodestone
