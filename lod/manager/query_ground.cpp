#include "lod/manager/query_ground.h"

#include <algorithm>
#include <cmath>

namespace lodestone {
namespace {

// m, of a ray to where something is met that is known by rays alone.
constexpr double kFarthestProbe = 1e6;

// Where it comes to in the next step.
GroundPose pose_of(const GroundPart& part) {
  return pose_after(part.pose, part.pose.comes_back ? 0.0 : part.pose.goes_on_s);
}

double height_of(const HalfSpace& plane, const Volume& volume) {
  const double reach =
      volume.is_box ? (volume.axes.transpose() * plane.normal).cwiseAbs().dot(volume.half) : volume.reach;
  return plane.height_of(volume.center) - reach;
}

}  // namespace

ContactSide QueryGround::side_of(GroundId id, MaterialId material) const {
  dxGeom* const geom = id ? callers_.geom_of(id) : nullptr;
  return {.kind = geom ? ContactSide::Kind::callers : ContactSide::Kind::ground,
          .ground = geom ? GroundId{} : id,
          .geom = geom,
          .material = material};
}

QueryHit QueryGround::hit_of(const GroundPart& part, const SurfaceHit& hit) const {
  return {side_of(part.id, part.material), hit.point, hit.normal, hit.distance};
}

void QueryGround::meet(const Sweep& sweep, const Found& found) {
  const auto meet_plane = [&](const HalfSpace& plane) {
    const double height = plane.height_of(sweep.from), falling = -plane.normal.dot(sweep.direction);
    if (sweep.radius == 0.0 ? height < 0.0 || falling <= 0.0 : height > sweep.radius && falling <= 0.0)
      return;
    const double distance = height <= sweep.radius ? 0.0 : (height - sweep.radius) / falling;
    if (distance > sweep.length) return;
    const Vec3 center = sweep.from + distance * sweep.direction;
    found({side_of(plane.id, plane.material), center - plane.height_of(center) * plane.normal, plane.normal,
           distance});
  };
  for (const HalfSpace& plane : ground_.planes()) meet_plane(plane);
  if (!ground_.has_parts()) return;
  std::vector<const GroundPart*> parts;
  {
    const std::lock_guard lock(access_);
    ground_.find_parts_along(sweep.from, sweep.direction, sweep.length, sweep.radius, parts);
  }
  for (const GroundPart* part : parts) {
    if (part->solids) {
      const GroundPose pose = pose_of(*part);
      if (const auto hit = solids_.meet(*part->solids, pose.position, pose.orientation, sweep))
        found(hit_of(*part, *hit));
      continue;
    }
    const std::lock_guard lock(access_);
    const auto hit = part->shape.probe(sweep.from, sweep.direction, std::min(sweep.length, kFarthestProbe));
    if (!hit) continue;
    if (sweep.radius > 0.0)
      meet_plane({hit->normal, hit->normal.dot(hit->point), part->material, part->id});
    else if (hit->normal.dot(sweep.direction) < 0.0)
      found({side_of(part->id, part->material), hit->point, hit->normal, hit->distance});
  }
}

void QueryGround::overlap(const Volume& volume, const Found& found) {
  const auto overlap_plane = [&](const HalfSpace& plane) {
    if (height_of(plane, volume) <= 0.0)
      found({side_of(plane.id, plane.material), volume.center - plane.height_of(volume.center) * plane.normal,
             plane.normal, 0.0});
  };
  for (const HalfSpace& plane : ground_.planes()) overlap_plane(plane);
  if (!ground_.has_parts()) return;
  std::vector<const GroundPart*> parts;
  {
    const std::lock_guard lock(access_);
    ground_.find_parts(volume.center, volume.reach, parts);
  }
  for (const GroundPart* part : parts) {
    if (part->solids) {
      const GroundPose pose = pose_of(*part);
      if (const auto hit = solids_.overlap(*part->solids, pose.position, pose.orientation, volume))
        found(hit_of(*part, *hit));
      continue;
    }
    const std::lock_guard lock(access_);
    if (const auto below = probe_below(*part, volume.center, volume.reach)) overlap_plane(*below);
  }
}

}  // namespace lodestone
