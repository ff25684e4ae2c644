#include "lod/tables/sphere_scene.h"

#include <algorithm>
#include <cmath>

#include "lod/contact/impact_waves.h"
#include "lod/tables/hull_separation.h"

namespace lodestone {
namespace {

bool is_turned(const StatisticalBody& body) { return std::abs(body.orientation.squaredNorm() - 1.0) < 1e-6; }

}  // namespace

bool is_sound(const StatisticalBody& body, const Shape& shape) {
  return is_turned(body) && is_within_limit(body.position) && is_within_limit(body.velocity) &&
         is_within_limit(angular_velocity(body.orientation, body.spin, shape));
}

bool SphereScene::is_unloaded(std::uint32_t first, std::uint32_t second, float impulse) const {
  const auto inverse_mass = [&](std::uint32_t place) {
    return std::int64_t(place) < spheres.awake ? float(spheres.inverse_mass[place]) : 0.0f;
  };
  return impulse * (inverse_mass(first) + inverse_mass(second)) <=
         float(ImpactWaves::kUnloaded) * bounce_velocity();
}

// In coarse steps, or pressed by others as a sphere and held as a hull, it might go on for ever, by as little
// as this.
bool SphereScene::is_nearly_still(const StatisticalBody& body, const BodyKind& kind,
                                  bool among_others) const {
  constexpr double kNearlyStill = 4.0;  // times what is still
  const double energy =
      kNearlyStill * rest_law.still_energy(among_others, kind.shape->radius, settings.gravity.norm());
  return 0.5 * body.velocity.squaredNorm() < energy && kinetic_energy(body, *kind.shape) < energy;
}

float SphereScene::ground_height(std::int64_t place, const Vec3& direction) const {
  if (!constants.hulls) return spheres.radius[std::size_t(place)];
  const Vec3 own = spheres.orientation(place).conjugate() * direction;
  return read_hull_height(kinds.hull_height.data(), int(spheres.kind[std::size_t(place)]) * kHullHeights,
                          {float(own.x()), float(own.y()), float(own.z())});
}

bool SphereScene::lies_flush(std::int64_t place, const Vec3& direction) const {
  const Vec3 own = spheres.orientation(place).conjugate() * direction;
  const lane::F3 towards{float(own.x()), float(own.y()), float(own.z())};
  const std::size_t at =
      std::size_t(int(spheres.kind[std::size_t(place)]) * kHullHeights + lane::place_in_map(towards).nearest);
  const lane::Row& face = kinds.pair_face[at];
  return dot({face.x, face.y, face.z}, towards) > lane::kFlushCosine + kinds.unsteady[at];
}

double SphereScene::exit_distance(std::int64_t place, const Vec3& direction) const {
  const auto i = std::size_t(place);
  if (!constants.hulls) return double(spheres.radius[i]);
  const Vec3 own = spheres.orientation(place).conjugate() * direction;
  const lane::MapPlace at = lane::place_in_map({float(own.x()), float(own.y()), float(own.z())});
  const lane::Row& face = kinds.pair_face[std::size_t(int(spheres.kind[i]) * kHullHeights + at.nearest)];
  const double cosine = Vec3(double(face.x), double(face.y), double(face.z)).dot(own);
  return cosine > 0.0 ? double(face.w) / cosine : double(face.w);
}

Vec3 SphereScene::meeting_point(std::int64_t first, std::int64_t second) const {
  const Vec3 from = spheres.position(second), between = spheres.position(first) - from;
  const double distance = between.norm();
  if (distance < 1e-12) return from;
  const Vec3 line = between / distance;
  return from + 0.5 * (exit_distance(second, line) + distance - exit_distance(first, -line)) * line;
}

std::pair<Vec3, double> SphereScene::separate(std::int64_t first, std::int64_t second) const {
  const Vec3 between = spheres.position(first) - spheres.position(second);
  const double distance = between.norm();
  const Vec3 along = distance > 1e-12 ? Vec3(between / distance) : Vec3(Vec3::UnitZ());
  if (!constants.hulls)
    return {along, distance - double(spheres.radius[std::size_t(first)]) -
                       double(spheres.radius[std::size_t(second)])};
  const auto placed = [&](std::int64_t place) {
    const std::size_t i = std::size_t(place);
    return lane::MappedHull{int(spheres.kind[i]) * kHullHeights,
                            {spheres.qw[i], {spheres.qx[i], spheres.qy[i], spheres.qz[i]}}};
  };
  const float* heights = kinds.pair_height.data();
  const lane::MappedHull one = placed(first), other = placed(second);
  const lane::F3 line{float(along.x()), float(along.y()), float(along.z())};
  const float per_gravity = -1.0f / std::max(constants.gravity, 1e-30f);
  const lane::F3 up{constants.gx * per_gravity, constants.gy * per_gravity, constants.gz * per_gravity};
  const lane::HullSeparation found = lane::separate_hulls(
      heights, kinds.pair_face.data(), kinds.unsteady.data(), one, other, line, float(distance),
      lane::separate_along_line(heights, one, other, line, float(distance)), {up, {}, 0.0f});
  return {Vec3(double(found.normal.x), double(found.normal.y), double(found.normal.z)), double(found.gap)};
}

void SphereScene::recover(std::int64_t place, ContactTally& tally) const {
  StatisticalBody body = spheres.body(place);
  if (is_sound(body, *kind_of(place).shape)) {
    spheres.put(place, body);
    return;
  }
  for (double& x : body.position) x = std::isfinite(x) ? std::clamp(x, -kStateLimit, kStateLimit) : 0.0;
  if (!is_turned(body)) body.orientation = Quat::Identity();
  body.velocity.setZero();
  body.spin.setZero();
  spheres.put(place, body);
  spheres.known_count[place] = 0;
  ++tally.states_recovered;
}

}  // namespace lodestone
