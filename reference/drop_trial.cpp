// Drops onto a plane: where they start, and the run to rest under ODE. Declared in trial.h.
#include "reference/drop_trial.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "reference/random.h"

namespace lodestone {
namespace {

constexpr double kNominalSizeMin = 0.2,
                 kNominalSizeMax = 0.4;  // m, the sizes that DropConditions' ranges are meant for

/// Height of the lowest point over the plane through the centre of mass; below zero.
double lowest_height(const Shape& shape, const Quat& orientation, const Vec3& normal) {
  if (shape.sphere_radius) return -*shape.sphere_radius;
  const Vec3 down = orientation.conjugate() * -normal;
  return -shape.hull.vertices[find_support(shape.hull, down)].dot(down);
}

}  // namespace

double drop_scale(const Shape& shape) {
  return shape.size / std::clamp(shape.size, kNominalSizeMin, kNominalSizeMax);
}

Vec3 drop_plane_normal(const DropConditions& conditions) {
  return {std::sin(conditions.slope), 0.0, std::cos(conditions.slope)};
}

RigidState drop_state(const Shape& shape, const DropConditions& conditions, std::uint64_t seed,
                      std::uint32_t trial) {
  RandomStream random(seed, trial, 1);
  const double scale = drop_scale(shape), speed = std::sqrt(scale) * conditions.speed_scale;
  const Vec3 normal = drop_plane_normal(conditions);
  RigidState state;
  state.orientation = random.orientation();
  const double height = scale * random.uniform(conditions.lowest_point_min, conditions.lowest_point_max);
  state.position = (height - lowest_height(shape, state.orientation, normal)) * normal;
  const double x = random.uniform(-1.0, 1.0), y = random.uniform(-1.0, 1.0), z = random.uniform(-1.0, 0.0);
  state.velocity = speed * Vec3(conditions.horizontal_speed * x, conditions.horizontal_speed * y,
                                conditions.falling_speed * z);
  const double angular_speed =
      random.uniform(0.0, conditions.angular_speed) * conditions.speed_scale / std::sqrt(scale);
  state.angular_velocity = angular_speed * random.direction();
  return state;
}

void simulate_drop(OdeWorld& world, OdeBodyId body, double horizon, int substeps,
                   const DropObserverFunction& observe) {
  const int last = int(std::lround(horizon / kObservationStep));
  for (int i = 0; observe(i * kObservationStep, world.state(body)) && i < last; ++i)
    world.step(kObservationStep, substeps);
}

}  // namespace lodestone
