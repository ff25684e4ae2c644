#include "lod/manager/query_callers.h"

#include <algorithm>

namespace lodestone {
namespace {

// Of a ray's way through a geom's ball, for which solids are looked up at a time.
constexpr double kPieces = 8.0;
constexpr int kFewSolids = 8;  // all of which are asked

struct Ball {
  Vec3 center;
  double radius = 0.0;
};
Ball ball_of(const CallersPart& part) {
  const Eigen::AlignedBox3d& bounds = part.solids->bounds();
  return {part.position + part.orientation * Vec3(bounds.center()), 0.5 * bounds.sizes().norm()};
}

QueryHit hit_of(const CallersPart& part, const SurfaceHit& hit) {
  return {{.kind = ContactSide::Kind::callers, .geom = part.geom, .callers = part.body},
          hit.point,
          hit.normal,
          hit.distance};
}

void find_solids(const CallersPart& part, const Vec3& center, double reach, std::vector<int>& found) {
  part.solids->find_near(part.orientation.conjugate() * (center - part.position), reach, found);
}

}  // namespace

PosedSurface QueryCallers::surface_of(const CallersPart& part, const GroundSolid& solid) {
  const TriangleTree* tree = solid.shape->sphere_radius ? nullptr : &trees_.of(solid.shape);
  return {tree, solid.shape->sphere_radius.value_or(0.0), part.position + part.orientation * solid.center,
          part.orientation};
}

std::optional<SurfaceHit> QueryCallers::meet(const CallersPart& part, const Sweep& sweep) {
  const Ball ball = ball_of(part);
  const double reach = ball.radius + sweep.radius;
  const auto enters = meet_sphere(sweep.from, sweep.direction, sweep.length, ball.center, reach);
  if (!enters) return {};
  std::vector<int> solids;
  if (part.solids->size() <= kFewSolids) {
    for (int i = 0; i < int(part.solids->size()); ++i) solids.push_back(i);
  } else {
    const double leaves = std::min(sweep.length, *enters + 2.0 * reach),
                 half = 0.5 * (leaves - *enters) / kPieces;
    for (double piece = 0.5; piece < kPieces; ++piece)
      find_solids(part, sweep.from + (*enters + 2.0 * piece * half) * sweep.direction, half + sweep.radius,
                  solids);
    std::ranges::sort(solids);
    solids.erase(std::unique(solids.begin(), solids.end()), solids.end());
  }
  std::optional<SurfaceHit> nearest;
  for (const int i : solids)
    if (const auto hit = lodestone::meet(surface_of(part, (*part.solids)[i]), sweep);
        hit && (!nearest || hit->distance < nearest->distance))
      nearest = hit;
  return nearest;
}

void QueryCallers::meet(std::span<const CallersPart> parts, unsigned categories, const Sweep& sweep,
                        const Found& found) {
  for (const CallersPart& part : parts)
    if ((part.category & categories) != 0)
      if (const auto hit = meet(part, sweep)) found(hit_of(part, *hit));
}

void QueryCallers::overlap(std::span<const CallersPart> parts, unsigned categories, const Volume& volume,
                           const Found& found) {
  for (const CallersPart& part : parts) {
    const Ball ball = ball_of(part);
    const double reach = ball.radius + volume.reach;
    if ((part.category & categories) == 0 || (ball.center - volume.center).squaredNorm() > reach * reach)
      continue;
    std::vector<int> solids;
    find_solids(part, volume.center, volume.reach, solids);
    for (const int i : solids) {
      auto hit = lodestone::overlap(surface_of(part, (*part.solids)[i]), volume);
      if (!hit) continue;
      if (volume.is_box) hit->point = part.position;
      found(hit_of(part, *hit));
      break;
    }
  }
}

}  // namespace lodestone
