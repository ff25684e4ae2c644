#include "reference/ode/height_field_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace lodestone::ode {
namespace {

Vec3 any_across(const Vec3& up) {
  return up.cross(std::abs(up.x()) < 0.7 ? Vec3(Vec3::UnitX()) : Vec3(Vec3::UnitY())).normalized();
}

}  // namespace

void HeightFieldContacts::find(const Body& body, dGeomID field, std::vector<ContactPoint>& points) {
  Above above{field, Vec3::UnitY(), 2.0 * body.reach};  // heights go along its own y
  if (is_placeable(field)) {
    const dReal* rotation = dGeomGetRotation(field);
    above.up = {rotation[1], rotation[5], rotation[9]};
  }
  const RigidState at = state_of(body.body);
  if (body.spheres.empty()) return find_of_corners(body, at, above, points);
  for (const Sphere& part : body.spheres)
    find_of_sphere(at.position + at.orientation * part.center, part.radius, above, points);
}

// The height of the ground above `point`, however deep that is; negative depth: below it, by as much. A ray
// along the edge of a cell may meet neither side: another is cast beside it.
std::optional<ContactPoint> HeightFieldContacts::find_depth(const Above& above, const Vec3& point) {
  const Vec3 from = point + above.reach * above.up;
  const auto cast = [&](const Vec3& start) {
    return probe_.cast(above.field, start, -above.up, 2.0 * above.reach);
  };
  std::optional<RayHit> hit = cast(from);
  if (!hit) hit = cast(from + 1e-4 * above.reach * any_across(above.up));
  if (!hit) return {};
  return ContactPoint{point, hit->normal, hit->normal.dot(hit->point - point)};
}

// Of a hull with many corners only those are asked for that are lower than the ground about them seems to be.
void HeightFieldContacts::find_of_corners(const Body& body, const RigidState& at, const Above& above,
                                          std::vector<ContactPoint>& points) {
  constexpr int kAcross = 5;        // rays each way, over the square about the body
  constexpr double kUneven = 0.25;  // over the reach: what may rise between two of them
  const std::vector<Vec3>& corners = body.shape->hull.vertices;
  const Vec3 x = any_across(above.up), y = above.up.cross(x);
  std::array<std::array<double, kAcross>, kAcross> ceiling;
  const bool few = corners.size() <= kAcross * kAcross;
  const double spacing = 2.0 * body.reach / (kAcross - 1);
  for (int i = 0; i < kAcross && !few; ++i)
    for (int j = 0; j < kAcross; ++j) {
      const Vec3 place = at.position + (i * spacing - body.reach) * x + (j * spacing - body.reach) * y;
      const auto found = find_depth(above, place);
      const double steep = found ? std::max(0.1, found->normal.dot(above.up)) : 1.0;
      ceiling[std::size_t(i)][std::size_t(j)] =
          found ? found->depth / steep + kUneven * body.reach : -std::numeric_limits<double>::infinity();
    }
  for (const Vec3& corner : corners) {
    const Vec3 arm = at.orientation * corner;
    if (!few) {
      const auto cell = [&](double along) {
        return std::size_t(std::clamp(int((along + body.reach) / spacing), 0, kAcross - 2));
      };
      const std::size_t i = cell(arm.dot(x)), j = cell(arm.dot(y));
      if (arm.dot(above.up) >
          std::max({ceiling[i][j], ceiling[i + 1][j], ceiling[i][j + 1], ceiling[i + 1][j + 1]}))
        continue;
    }
    if (const auto found = find_depth(above, at.position + arm); found && found->depth > 0.0)
      points.push_back(*found);
  }
}

// The point below its centre, those around it, and of each face of the ground that any of these lies over the
// point that is deepest in that.
void HeightFieldContacts::find_of_sphere(const Vec3& center, double radius, const Above& above,
                                         std::vector<ContactPoint>& points) {
  constexpr int kAround = 8;
  const Vec3 x = any_across(above.up), y = above.up.cross(x);
  std::vector<Vec3> ways;  // out of the ground
  const auto ask = [&](const Vec3& out) {
    const auto found = find_depth(above, center - radius * out);
    if (found && found->depth > 0.0) points.push_back(*found);
    if (found &&
        std::ranges::none_of(ways, [&](const Vec3& way) { return way.dot(found->normal) > 1.0 - 1e-9; }))
      ways.push_back(found->normal);
  };
  ask(above.up);
  for (int i = 0; i < kAround; ++i) {
    const double turn = 2.0 * std::numbers::pi * i / kAround;
    ask((above.up + std::cos(turn) * x + std::sin(turn) * y).normalized());
  }
  for (std::size_t i = 0; i < ways.size() && i < 2 * kAround; ++i) ask(Vec3(ways[i]));
}

}  // namespace lodestone::ode
