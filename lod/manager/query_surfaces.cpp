#include "lod/manager/query_surfaces.h"

#include <algorithm>
#include <limits>

namespace lodestone {
namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();

SurfaceHit placed(SurfaceHit hit, const Vec3& position, const Quat& orientation) {
  hit.point = position + orientation * hit.point;
  hit.normal = orientation * hit.normal;
  return hit;
}

Sweep seen_from(const Vec3& position, const Quat& orientation, Sweep sweep) {
  const Quat back = orientation.conjugate();
  sweep.from = back * (sweep.from - position), sweep.direction = back * sweep.direction;
  return sweep;
}

Volume seen_from(const Vec3& position, const Quat& orientation, Volume volume) {
  const Quat back = orientation.conjugate();
  volume.center = back * (volume.center - position), volume.axes = back.toRotationMatrix() * volume.axes;
  return volume;
}

template <class Question>
Question ask(const SurfaceSolids& surface, Question question) {
  surface.visit_triangles([&](const Eigen::AlignedBox3d& box) { return question.may_meet(box); },
                          [&](const Triangle& triangle) { question.ask(triangle); });
  return question;
}

// Of a surface in whose solid `point` lies.
SurfaceHit nearest_of(const std::optional<SurfaceHit>& nearest) {
  SurfaceHit hit = *nearest;
  hit.distance = 0.0;
  return hit;
}

std::optional<SurfaceHit> meet_ball(const PosedSurface& sphere, const Sweep& sweep) {
  const auto distance = meet_sphere(sweep.from, sweep.direction, sweep.length, sphere.position,
                                    sphere.sphere_radius + sweep.radius);
  if (!distance || (*distance == 0.0 && sweep.radius == 0.0)) return {};  // begun inside
  const Vec3 apart = sweep.from + *distance * sweep.direction - sphere.position;
  const Vec3 normal = apart.norm() > 0.0 ? Vec3(apart.normalized()) : Vec3(Vec3::UnitZ());
  return SurfaceHit{*distance, sphere.position + sphere.sphere_radius * normal, normal};
}

std::optional<SurfaceHit> overlap_ball(const PosedSurface& sphere, const Volume& volume) {
  const Vec3 apart = volume.center - sphere.position;
  if (volume.is_box) {
    const Eigen::AlignedBox3d box(-volume.half, volume.half);
    return box.exteriorDistance(volume.axes.transpose() * -apart) <= sphere.sphere_radius
               ? std::optional(SurfaceHit{0.0, sphere.position, Vec3::UnitZ()})
               : std::nullopt;
  }
  if (apart.norm() > sphere.sphere_radius + volume.reach) return {};
  const Vec3 normal = apart.norm() > 0.0 ? Vec3(apart.normalized()) : Vec3(Vec3::UnitZ());
  return SurfaceHit{0.0, sphere.position + sphere.sphere_radius * normal, normal};
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
  if (!surface.tree) return meet_ball(surface, sweep);
  const Sweep own = seen_from(surface.position, surface.orientation, sweep);
  const std::optional<SurfaceHit> hit =
      own.radius > 0.0 && surface.tree->contains(own.from)
          ? nearest_of(surface.tree->ask(NearestPoint(own.from, kEndless)).hit())
          : surface.tree->ask(FirstMet(own.from, own.direction, own.length, own.radius)).hit();
  return hit ? std::optional(placed(*hit, surface.position, surface.orientation)) : std::nullopt;
}

std::optional<SurfaceHit> overlap(const PosedSurface& surface, const Volume& volume) {
  if (!surface.tree) return overlap_ball(surface, volume);
  const Volume own = seen_from(surface.position, surface.orientation, volume);
  if (own.is_box)
    return surface.tree->ask(MeetsBox(own.center, own.axes, own.half)).met() ||
                   surface.tree->contains(own.center)
               ? std::optional(SurfaceHit{0.0, surface.position, Vec3::UnitZ()})
               : std::nullopt;
  std::optional<SurfaceHit> hit = surface.tree->ask(NearestPoint(own.center, own.reach)).hit();
  if (!hit && surface.tree->contains(own.center))
    hit = surface.tree->ask(NearestPoint(own.center, kEndless)).hit();
  if (!hit) return {};
  return placed(nearest_of(hit), surface.position, surface.orientation);
}

PosedSurface SolidQueries::surface_of(const GroundSolid& solid) {
  const std::shared_ptr<const Shape>& shape = solid.shape;
  if (shape->sphere_radius) return {nullptr, *shape->sphere_radius, solid.center, Quat::Identity()};
  return {&trees_.of(shape), 0.0, solid.center, Quat::Identity()};
}

bool SolidQueries::is_within(const SurfaceSolids& surface, const Vec3& point) {
  std::vector<int> near;
  surface.find_near(point, 0.0, 0, near);
  return std::ranges::any_of(near, [&](int i) {
    const GroundSolid& solid = surface[std::size_t(i)];
    return trees_.of(solid.shape).contains(point - solid.center);
  });
}

std::optional<SurfaceHit> SolidQueries::meet(const SurfaceSolids& surface, const Sweep& sweep) {
  if (sweep.radius > 0.0 && is_within(surface, sweep.from))
    return nearest_of(ask(surface, NearestPoint(sweep.from, kEndless)).hit());
  return ask(surface, FirstMet(sweep.from, sweep.direction, sweep.length, sweep.radius)).hit();
}

std::optional<SurfaceHit> SolidQueries::overlap(const SurfaceSolids& surface, const Volume& volume) {
  if (volume.is_box) {
    const std::optional<Vec3> met = ask(surface, MeetsBox(volume.center, volume.axes, volume.half)).met();
    if (!met && !is_within(surface, volume.center)) return {};
    return SurfaceHit{0.0, met.value_or(volume.center), Vec3::UnitZ()};
  }
  auto hit = ask(surface, NearestPoint(volume.center, volume.reach)).hit();
  if (!hit && is_within(surface, volume.center))
    hit = ask(surface, NearestPoint(volume.center, kEndless)).hit();
  return hit ? std::optional(nearest_of(hit)) : std::nullopt;
}

std::optional<SurfaceHit> SolidQueries::meet(const GroundSolids& solids, const Vec3& position,
                                             const Quat& orientation, const Sweep& sweep) {
  std::optional<SurfaceHit> first;
  Sweep own = seen_from(position, orientation, sweep);
  const auto take = [&](const std::optional<SurfaceHit>& hit) {
    if (hit && (!first || hit->distance < first->distance)) first = hit, own.length = hit->distance;
  };
  solids.visit_bodies_along(own.from, own.direction, own.length, own.radius, [&](int i) {
    take(lodestone::meet(surface_of(solids.bodies()[std::size_t(i)]), own));
  });
  if (solids.surface()) take(meet(*solids.surface(), own));
  return first ? std::optional(placed(*first, position, orientation)) : std::nullopt;
}

std::optional<SurfaceHit> SolidQueries::overlap(const GroundSolids& solids, const Vec3& position,
                                                const Quat& orientation, const Volume& volume) {
  const Volume own = seen_from(position, orientation, volume);
  std::vector<int> near;
  solids.find_bodies_near(own.center, own.reach, near);
  std::optional<SurfaceHit> hit;
  for (const int i : near)
    if ((hit = lodestone::overlap(surface_of(solids.bodies()[std::size_t(i)]), own))) break;
  if (!hit && solids.surface()) hit = overlap(*solids.surface(), own);
  if (!hit) return {};
  *hit = placed(*hit, position, orientation);
  if (volume.is_box) hit->normal = Vec3::UnitZ();
  return hit;
}

}  // namespace lodestone
