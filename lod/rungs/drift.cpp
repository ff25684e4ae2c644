#include "lod/rungs/drift.h"

namespace lodestone {

Vec3 find_drift(double dt, const TablesLevel& tables, const SupportLevel& support,
                std::span<const FullNeighbor> neighbors) {
  constexpr std::size_t kMostLookedAt = 1024;  // of each rung, evenly among its bodies
  constexpr double kFar = 1.0;                 // over R, on average: a way in a step
  constexpr double kAsOne = 0.1;               // of the mean square of all, what is left of it in the frame
  double count = 0.0, square = 0.0, radii = 0.0;
  Vec3 sum = Vec3::Zero();
  const auto each_of = [](std::size_t bodies, const auto& visit) {
    const std::size_t stride = 1 + bodies / kMostLookedAt;
    for (std::size_t i = 0; i < bodies; i += stride) visit(i, double(stride));
  };
  const auto look_at = [&](double stands_for, const Vec3& velocity, double radius) {
    count += stands_for, radii += stands_for * radius;
    sum += stands_for * velocity, square += stands_for * velocity.squaredNorm();
  };
  const std::span<const std::int32_t> spheres = tables.awake(), hulls = support.awake();
  each_of(spheres.size(), [&](std::size_t i, double stands_for) {
    look_at(stands_for, tables.spheres().velocity(std::int64_t(i)), tables.radius(spheres[i]));
  });
  each_of(hulls.size(), [&](std::size_t i, double stands_for) {
    const StatisticalBody& body = support.body(hulls[i]);
    look_at(stands_for, body.velocity, support.kind_of(body).shape->radius);
  });
  each_of(neighbors.size(), [&](std::size_t i, double stands_for) {
    const FullNeighbor& n = neighbors[i];
    if (!n.asleep) look_at(stands_for, n.state.velocity, n.shape->radius);
  });
  if (count == 0.0) return Vec3::Zero();
  const Vec3 mean = sum / count;
  const bool far = mean.norm() * dt > kFar * radii / count;
  return far && square - count * mean.squaredNorm() < kAsOne * square ? mean : Vec3(Vec3::Zero());
}

}  // namespace lodestone
