// Dart throwing: draw until there is room (Cook, Stochastic sampling in computer graphics, 1986). Simple, and
// quick while the spheres fill less than about a quarter of the region.
#include "scenes/scatter.h"

#include <algorithm>
#include <cmath>

#include "reference/random.h"

namespace lodestone {
namespace {

constexpr int kDraws = 2000;
constexpr std::uint32_t kPlaceStream = 0, kOrientationStream = 1;

Vec3 draw_within(const ScatterBox& box, RandomStream& stream) {
  const Vec3 size = box.high - box.low;
  const double x = stream.uniform(), y = stream.uniform(), z = stream.uniform();
  return {size.x() * x, size.y() * y, size.z() * z};
}

Vec3 draw_within(const ScatterCylinder& cylinder, RandomStream& stream) {
  const double r = cylinder.radius * std::sqrt(stream.uniform());
  const double angle = stream.uniform(0.0, 2.0 * std::numbers::pi);
  return {r * std::cos(angle), r * std::sin(angle), cylinder.height * stream.uniform()};
}

Vec3 origin_of(const ScatterRegion& region) {
  if (const auto* box = std::get_if<ScatterBox>(&region)) return box->low;
  return std::get<ScatterCylinder>(region).base;
}

}  // namespace

std::uint64_t PlacedSpheres::key_of(const Vec3& point, int dx, int dy, int dz) const {
  const auto cell = [&](int axis, int shift) {
    return std::uint64_t(std::int64_t(std::floor(point[axis] / cell_)) + shift);
  };
  return cell(0, dx) * 73856093 ^ cell(1, dy) * 19349663 ^ cell(2, dz) * 83492791;
}

void PlacedSpheres::add(const Vec3& center, double radius) {
  cells_.emplace(key_of(center, 0, 0, 0), Sphere{center, radius});
}

bool PlacedSpheres::overlaps(const Vec3& center, double radius) const {
  for (int shift = 0; shift < 27; ++shift) {
    const auto [begin, end] =
        cells_.equal_range(key_of(center, shift % 3 - 1, shift / 3 % 3 - 1, shift / 9 - 1));
    for (auto near = begin; near != end; ++near)
      if ((near->second.center - center).norm() < radius + near->second.radius) return true;
  }
  return false;
}

std::vector<Vec3> place_scatter(const Scatter& scatter, double radius, std::span<const KeepAbove> grounds,
                                PlacedSpheres& placed, const PutOnGround& put) {
  const double own_radius = std::max(radius, 0.5 * scatter.spacing_m);
  PlacedSpheres own(own_radius);  // apart from `placed`, since the spacing holds within this scatter only
  std::vector<Vec3> centers;
  for (int i = 0; i < scatter.count; ++i) {
    RandomStream stream(scatter.seed, std::uint64_t(i), kPlaceStream);
    bool found = false;
    for (int draw = 0; draw < kDraws && !found; ++draw) {
      Vec3 local =
          std::visit([&](const auto& region) { return draw_within(region, stream); }, scatter.region);
      if (put) {
        const std::optional<Vec3> start = put(i, origin_of(scatter.region) + local);
        if (!start) continue;
        local = *start - origin_of(scatter.region);
      }
      const Vec3 center = origin_of(scatter.region) + local;
      const auto is_above = [&](const KeepAbove& ground) {
        return ground.normal.dot(center) - ground.offset >= radius;
      };
      found = (put || std::ranges::all_of(grounds, is_above)) && !own.overlaps(local, own_radius) &&
              !placed.overlaps(center, radius);
      if (!found) continue;
      own.add(local, own_radius);
      centers.push_back(center);
    }
    if (!found) break;
  }
  for (const Vec3& center : centers) placed.add(center, radius);
  return centers;
}

Quat scatter_orientation(const Scatter& scatter, int index) {
  return RandomStream(scatter.seed, std::uint64_t(index), kOrientationStream).orientation();
}

double scatter_turn(const Scatter& scatter, int index) {
  return RandomStream(scatter.seed, std::uint64_t(index), kOrientationStream)
      .uniform(0.0, 2.0 * std::numbers::pi);
}

}  // namespace lodestone
