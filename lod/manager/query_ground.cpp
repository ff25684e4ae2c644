#include "lod/manager/query_ground.h"

#include <algorithm>
#include <cmath>

namespace lodestone {
namespace {

constexpr double kPiece = 2.0;  // m: of a ray, for which solids are looked up at a time
constexpr double kMostPieces = 256.0;
// m, from where a ray comes to the ground: beyond, it meets planes alone.
constexpr double kFarthestPiece = 1e6;

SurfaceHit in_world(const PosedSurface& surface, SurfaceHit hit) {
  hit.point = surface.position + surface.orientation * hit.point;
  hit.normal = surface.orientation * hit.normal;
  return hit;
}

double height_of(const HalfSpace& plane, const Volume& volume) {
  const double reach =
      volume.is_box ? (volume.axes.transpose() * plane.normal).cwiseAbs().dot(volume.half) : volume.reach;
  return plane.height_of(volume.center) - reach;
}

}  // namespace

const TriangleTree& ShapeTrees::of(const std::shared_ptr<const Shape>& shape) {
  const std::lock_guard lock(access_);
  if (trees_.size() >= most_ && !trees_.contains(shape.get())) drop_unused();
  Entry& entry = trees_[shape.get()];
  if (!entry.tree)
    entry = {shape, std::make_unique<const TriangleTree>(shape->mesh.faces.empty()
                                                             ? Mesh{shape->hull.vertices, shape->hull.faces}
                                                             : shape->mesh)};
  return *entry.tree;
}

// What a question is about is not unused: its body or piece of the ground has the shape.
void ShapeTrees::drop_unused() {
  std::erase_if(trees_, [](const auto& known) { return known.second.shape.use_count() == 1; });
  most_ = std::max(most_, 2 * trees_.size());
}

std::optional<SurfaceHit> meet(const PosedSurface& surface, const Sweep& sweep) {
  if (!surface.tree) {
    const auto distance = meet_sphere(sweep.from, sweep.direction, sweep.length, surface.position,
                                      surface.sphere_radius + sweep.radius);
    if (!distance || (*distance == 0.0 && sweep.radius == 0.0)) return {};  // begun inside
    const Vec3 apart = sweep.from + *distance * sweep.direction - surface.position;
    const Vec3 normal = apart.norm() > 0.0 ? Vec3(apart.normalized()) : Vec3(Vec3::UnitZ());
    return SurfaceHit{*distance, surface.position + surface.sphere_radius * normal, normal};
  }
  const Quat back = surface.orientation.conjugate();
  const Vec3 from = back * (sweep.from - surface.position), direction = back * sweep.direction;
  std::optional<SurfaceHit> hit;
  if (sweep.radius == 0.0) {
    hit = surface.tree->cast(from, direction, sweep.length);
  } else if (surface.tree->contains(from)) {
    hit = surface.tree->find_nearest(from, 1e300);
    hit->distance = 0.0;
  } else {
    hit = surface.tree->sweep(from, direction, sweep.length, sweep.radius);
  }
  return hit ? std::optional(in_world(surface, *hit)) : std::nullopt;
}

std::optional<SurfaceHit> overlap(const PosedSurface& surface, const Volume& volume) {
  if (volume.is_box) {
    const SurfaceHit hit{0.0, surface.position, Vec3::UnitZ()};
    if (!surface.tree) {
      const Vec3 center = volume.axes.transpose() * (surface.position - volume.center);
      return Eigen::AlignedBox3d(-volume.half, volume.half).exteriorDistance(center) <= surface.sphere_radius
                 ? std::optional(hit)
                 : std::nullopt;
    }
    const Mat3 back = surface.orientation.conjugate().toRotationMatrix();
    const Vec3 center = back * (volume.center - surface.position);
    return surface.tree->meets_box(center, back * volume.axes, volume.half) || surface.tree->contains(center)
               ? std::optional(hit)
               : std::nullopt;
  }
  const Vec3 apart = volume.center - surface.position;
  if (!surface.tree) {
    if (apart.norm() > surface.sphere_radius + volume.reach) return {};
    const Vec3 normal = apart.norm() > 0.0 ? Vec3(apart.normalized()) : Vec3(Vec3::UnitZ());
    return SurfaceHit{0.0, surface.position + surface.sphere_radius * normal, normal};
  }
  const Vec3 center = surface.orientation.conjugate() * apart;
  auto hit = surface.tree->find_nearest(center, volume.reach);
  if (!hit && surface.tree->contains(center)) hit = surface.tree->find_nearest(center, 1e300);
  if (!hit) return {};
  hit->distance = 0.0;
  return in_world(surface, *hit);
}

ContactSide QueryGround::side_of(GroundId id, MaterialId material) const {
  dxGeom* const geom = id ? callers_.geom_of(id) : nullptr;
  return {.kind = geom ? ContactSide::Kind::callers : ContactSide::Kind::ground,
          .ground = geom ? GroundId{} : id,
          .geom = geom,
          .material = material};
}

PosedSurface QueryGround::surface_of(const PlacedSolid& solid) {
  const std::shared_ptr<const Shape>& shape = solid.solid->shape;
  if (shape->sphere_radius) return {nullptr, *shape->sphere_radius, solid.position, solid.orientation};
  return {&trees_.of(shape), 0.0, solid.position, solid.orientation};
}

// Each once, in the order of their numbers. `probed`: parts that are known by rays only.
std::vector<PlacedSolid> QueryGround::find_near(const Vec3& center, double reach,
                                                std::vector<const GroundPart*>& probed) {
  std::vector<const GroundPart*> parts;
  std::vector<PlacedSolid> solids;
  const std::lock_guard lock(access_);
  ground_.find_parts(center, reach, parts);
  for (const GroundPart* part : parts) {
    if (part->shape.make)
      find_solids(*part, center, reach, part->pose.comes_back ? 0.0 : part->pose.goes_on_s, solids);
    else if (part->shape.probe)
      probed.push_back(part);
  }
  return solids;
}

// m, of a ray: where it comes within `margin` of the box, and where it leaves that. None: nowhere.
std::optional<std::pair<double, double>> find_within(const Eigen::AlignedBox3d& box, const Sweep& sweep,
                                                     double margin) {
  double begin = 0.0, end = sweep.length;
  for (int a = 0; a < 3; ++a) {
    const double low = box.min()[a] - margin - sweep.from[a], high = box.max()[a] + margin - sweep.from[a],
                 way = sweep.direction[a];
    if (way == 0.0) {
      if (low > 0.0 || high < 0.0) return {};
      continue;
    }
    begin = std::max(begin, std::min(low / way, high / way));
    end = std::min(end, std::max(low / way, high / way));
  }
  return begin <= end ? std::optional(std::pair(begin, end)) : std::nullopt;
}

// Piece by piece, of a long ray what is near any ground.
std::vector<PlacedSolid> QueryGround::find_along(const Sweep& sweep, std::vector<const GroundPart*>& probed) {
  std::vector<PlacedSolid> all;
  double begin = 0.0, end = sweep.length;
  if (end > kMostPieces * kPiece) {
    const std::lock_guard lock(access_);
    const auto within = find_within(ground_.bounds_of_parts(), sweep, sweep.radius);
    if (!within) return all;
    begin = within->first, end = std::min(within->second, begin + kFarthestPiece);
  }
  const double piece = std::max(kPiece, (end - begin) / kMostPieces);
  const auto pieces =
      int(std::floor((end - begin) / piece)) + 1;  // counted: far away a piece may add nothing
  for (int i = 0; i < pieces; ++i) {
    const double at = begin + i * piece, half = 0.5 * std::clamp(end - at, 0.0, piece);
    for (const PlacedSolid& solid :
         find_near(sweep.from + (at + half) * sweep.direction, half + sweep.radius, probed))
      all.push_back(solid);
  }
  std::ranges::sort(all, {}, &PlacedSolid::number);
  all.erase(std::unique(all.begin(), all.end(),
                        [](const PlacedSolid& a, const PlacedSolid& b) { return a.number == b.number; }),
            all.end());
  std::ranges::sort(probed, {}, [](const GroundPart* part) { return part->id.index; });
  probed.erase(std::unique(probed.begin(), probed.end()), probed.end());
  return all;
}

// A part is met once, where it is met first: it may be of many solids.
void QueryGround::meet_parts(std::span<const PlacedSolid> solids,
                             const std::function<std::optional<SurfaceHit>(const PosedSurface&)>& meet_one,
                             const Found& found) {
  std::vector<std::pair<const GroundPart*, SurfaceHit>> hits;
  for (const PlacedSolid& solid : solids)
    if (const auto hit = meet_one(surface_of(solid))) hits.emplace_back(solid.part, *hit);
  std::ranges::stable_sort(hits, [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first->id.index < b.first->id.index : a.second.distance < b.second.distance;
  });
  const GroundPart* last = nullptr;
  for (const auto& [part, hit] : hits)
    if (std::exchange(last, part) != part)
      found({side_of(part->id, part->material), hit.point, hit.normal, hit.distance});
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
  std::vector<const GroundPart*> probed;
  meet_parts(
      find_along(sweep, probed), [&](const PosedSurface& surface) { return lodestone::meet(surface, sweep); },
      found);
  for (const GroundPart* part : probed) {
    const std::lock_guard lock(access_);
    const auto hit = part->shape.probe(sweep.from, sweep.direction, std::min(sweep.length, kFarthestPiece));
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
  std::vector<const GroundPart*> probed;
  meet_parts(
      find_near(volume.center, volume.reach, probed),
      [&](const PosedSurface& surface) { return lodestone::overlap(surface, volume); }, found);
  for (const GroundPart* part : probed) {
    const std::lock_guard lock(access_);
    if (const auto below = probe_below(*part, volume.center, volume.reach)) overlap_plane(*below);
  }
}

}  // namespace lodestone
