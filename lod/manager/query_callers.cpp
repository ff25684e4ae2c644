#include "lod/manager/query_callers.h"

namespace lodestone {
namespace {

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

}  // namespace

void QueryCallers::meet(std::span<const CallersPart> parts, unsigned categories, const Sweep& sweep,
                        const Found& found) {
  for (const CallersPart& part : parts) {
    const Ball ball = ball_of(part);
    if ((part.category & categories) == 0 ||
        !meet_sphere(sweep.from, sweep.direction, sweep.length, ball.center, ball.radius + sweep.radius))
      continue;
    if (const auto hit = solids_.meet(*part.solids, part.position, part.orientation, sweep))
      found(hit_of(part, *hit));
  }
}

void QueryCallers::overlap(std::span<const CallersPart> parts, unsigned categories, const Volume& volume,
                           const Found& found) {
  for (const CallersPart& part : parts) {
    const Ball ball = ball_of(part);
    const double reach = ball.radius + volume.reach;
    if ((part.category & categories) == 0 || (ball.center - volume.center).squaredNorm() > reach * reach)
      continue;
    auto hit = solids_.overlap(*part.solids, part.position, part.orientation, volume);
    if (!hit) continue;
    if (volume.is_box) hit->point = part.position;
    found(hit_of(part, *hit));
  }
}

}  // namespace lodestone
