#include "lod/callers/callers_ground.h"

#include <algorithm>

#include "lod/callers/geom_solids.h"
#include "reference/ode/callers_bodies.h"

namespace lodestone {
namespace {

using Box = Eigen::AlignedBox3d;

const Box kEverywhere(Vec3::Constant(-1e9), Vec3::Constant(1e9));  // m

Box in_own_frame(const MirroredGeom& geom) {
  // A height field that repeats itself has no bounds.
  const Box bounds(geom.bounds.min().cwiseMax(-kStateLimit), geom.bounds.max().cwiseMin(kStateLimit));
  const Vec3 center = geom.orientation.conjugate() * (bounds.center() - geom.position);
  const Vec3 reach = geom.orientation.conjugate().toRotationMatrix().cwiseAbs() * (0.5 * bounds.sizes());
  return {center - reach, center + reach};
}

// However it is turned when it is first seen: a manager that is restored sees it later, and is to go on
// alike.
Box in_own_frame(const GeomShape& shape) {
  const std::vector<Vec3> corners = shape.kind == GeomKind::trimesh ? shape.vertices : corners_of(shape);
  Box bounds;
  for (const Vec3& corner : corners) bounds.extend(corner);
  return bounds;
}

HalfSpace plane_of(const MirroredGeom& geom) {
  return {.normal = geom.normal, .offset = geom.offset, .bits = {geom.category, geom.collide, true}};
}

}  // namespace

void CallersGround::follow(const SpaceMirror& mirror, double dt, double since, const Vec3& up,
                           const Wakes& wakes) {
  const std::span<const MirroredGeom> geoms = mirror.geoms();
  ids_.resize(geoms.size());
  for (const std::uint32_t slot : mirror.removed()) {
    if (!ids_[slot]) continue;
    if (!ground_.is_plane(ids_[slot]))
      wakes.gone(ground_.bounds(ids_[slot]));
    else
      wakes.disturbed(kEverywhere);
    remove(slot);
  }
  for (const std::uint32_t slot : mirror.added()) {
    if (geoms[slot].dynamic) continue;
    add(geoms[slot], slot, dt);
    if (ground_.is_plane(ids_[slot]))
      wakes.came(plane_of(geoms[slot]));
    else
      wakes.disturbed(geoms[slot].bounds);
  }
  std::erase_if(moving_, [&](std::uint32_t slot) {
    if (!ids_[slot]) return true;
    const bool moved = std::ranges::binary_search(mirror.moved(), slot);
    if (since == 0.0 && !moved && !geoms[slot].body) return false;
    ground_.move_part(ids_[slot], pose_of(geoms[slot], dt, 0.0));
    if (!moved) wakes.gone(geoms[slot].bounds);  // it stands again: who was left behind wakes
    return true;
  });
  const auto move = [&](std::uint32_t slot, bool moved) {
    const GroundPose pose = pose_of(geoms[slot], dt, moved ? since : 0.0);
    ground_.move_part(ids_[slot], pose);
    if (!ground_.part(ids_[slot]).moves() && !moved) return;
    moving_.push_back(slot);
    const Eigen::AlignedBox3d &now = geoms[slot].bounds, &before = geoms[slot].previous_bounds;
    if (before.intersects(now)) return wakes.disturbed(now.merged(before));
    wakes.gone(before);
    wakes.disturbed(now);
  };
  for (const std::uint32_t slot : mirror.moved()) {
    if (!ids_[slot]) continue;
    if (!ground_.is_plane(ids_[slot]))
      move(slot, true);
    else
      ground_.move_plane(ids_[slot], plane_of(geoms[slot])), wakes.disturbed(kEverywhere);
  }
  for (const std::uint32_t slot : carried_)
    if (!std::ranges::binary_search(mirror.moved(), slot)) move(slot, false);
  for (const std::uint32_t slot : probed_)
    ground_.set_up(ids_[slot], geoms[slot].orientation.conjugate() * up);
}

void CallersGround::add(const MirroredGeom& geom, std::uint32_t slot, double dt) {
  if (geom.kind == GeomKind::plane) {
    ids_[slot] = ground_.add_plane(plane_of(geom));
  } else {
    GroundShape shape{.bounds = in_own_frame(geom)};
    shape.bits = {geom.category, geom.collide, true};
    if (geom.kind == GeomKind::height_field || geom.kind == GeomKind::other) {
      shape.probe = [probe = probe_, own = geom.geom](const Vec3& from, const Vec3& direction,
                                                      double length) -> std::optional<GroundHit> {
        const std::optional<RayHit> hit = probe->cast(own, from, direction, length);
        return hit ? std::optional(GroundHit{hit->point, hit->normal, hit->distance}) : std::nullopt;
      };
      if (geom.kind == GeomKind::height_field)
        shape.up = Vec3::UnitY();
      else
        probed_.push_back(slot);
    } else {
      shape.make = [own = geom.geom] { return solids_of(read_geom(own)); };
      const bool is_dear = geom.kind == GeomKind::trimesh || geom.kind == GeomKind::convex,
                 is_great = is_dear && !geom.body;  // read once somebody comes near
      if (const Box own = is_great ? Box() : in_own_frame(read_geom(geom.geom)); !own.isEmpty())
        shape.bounds = own;
    }
    ids_[slot] = ground_.add_part(shape, pose_of(geom, dt, 0.0), 0);
    if (geom.body) carried_.insert(std::ranges::lower_bound(carried_, slot), slot);
  }
  const GroundId id = ids_[slot];
  geoms_.resize(std::max(geoms_.size(), std::size_t(id.index) + 1), nullptr);
  geoms_[id.index] = geom.geom;
}

void CallersGround::remove(std::uint32_t slot) {
  geoms_[ids_[slot].index] = nullptr;
  ground_.remove(ids_[slot]);
  ids_[slot] = {};
  std::erase(carried_, slot);
  std::erase(moving_, slot);
  std::erase(probed_, slot);
}

// One that a kinematic body carries moves as that does; one that was put elsewhere since the last step came
// from there.
GroundPose CallersGround::pose_of(const MirroredGeom& geom, double dt, double moved_in) const {
  GroundPose pose{geom.position, geom.orientation};
  if (geom.body) {
    const RigidState body = callers::state(geom.body);
    pose.velocity = body.velocity + body.angular_velocity.cross(geom.position - body.position);
    pose.angular_velocity = body.angular_velocity;
    pose.goes_on_s = pose.velocity.isZero(0.0) && pose.angular_velocity.isZero(0.0) ? 0.0 : dt;
  }
  if (pose.goes_on_s > 0.0 || moved_in == 0.0) return pose;
  const double rim = (geom.bounds.center() - geom.position).norm() + 0.5 * geom.bounds.sizes().norm();
  const GroundPose put = put_from({geom.previous_position, geom.previous_orientation}, pose, rim, moved_in);
  const bool is_probed = geom.kind == GeomKind::height_field || geom.kind == GeomKind::other;
  return is_probed ? put : coming_to(put, moved_in, dt);
}

// By where they stand: a space gives out first what was moved last.
void CallersGround::archive(StateArchive& a, const SpaceMirror& mirror) {
  std::vector<GeomPlace> places;
  for (const std::uint32_t slot : moving_)
    if (mirror.geoms()[slot].geom) places.push_back(mirror.place_of(slot));
  a(places);
  if (!a.reading()) return;
  moving_.clear();
  for (const GeomPlace& place : places)
    if (const auto slot = mirror.find_at(place, moving_)) moving_.push_back(*slot);
  std::ranges::sort(moving_);
}

dxGeom* CallersGround::geom_of(GroundId id) const {
  return ground_.valid(id) && id.index < geoms_.size() ? geoms_[id.index] : nullptr;
}

}  // namespace lodestone
