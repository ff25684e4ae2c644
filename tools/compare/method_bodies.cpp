#include "tools/compare/method_bodies.h"

namespace lodestone {

ManagerSettings manager_settings_of(const StatisticalMethod& method, std::uint64_t seed) {
  ManagerSettings settings;
  settings.seed = seed;
  settings.model = method.model;
  settings.tables.published = method.published;
  settings.signatures = [signature = method.signature](const Shape&, const ContactLaw&) { return signature; };
  return settings;
}

BodyDefinition statistical_body_of(const DropJob& job, const RigidState& state) {
  return {.shape = job.shape, .state = state, .level = LevelChoice::statistical};
}

OdeBodyDefinition ode_body_of(const DropJob& job, const OdeMethod& way, const RigidState& state) {
  return {.shape = way.collision_shape,
          .mass = job.material.density * job.shape->volume,
          .state = state,
          .geometry = way.geometry,
          .spheres = way.spheres};
}

BulletBodyDefinition bullet_body_of(const DropJob& job, const BulletMethod& way, const RigidState& state) {
  return {.shape = job.shape,
          .mass = job.material.density * job.shape->volume,
          .material = job.material,
          .state = state,
          .geometry = way.geometry};
}

}  // namespace lodestone
