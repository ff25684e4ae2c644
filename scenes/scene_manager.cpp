#include "scenes/scene_manager.h"

#include "scenes/camera.h"

namespace lodestone {

PolicySettings policy_of(const Scene& scene, const RunSettings& settings) {
  PolicySettings policy = scene.lod;
  const bool by_error = std::holds_alternative<ErrorBudgetPolicy>(policy.policy);
  if (settings.budget_ms && by_error)
    policy.policy = ErrorBudgetPolicy{.budget_ms = *settings.budget_ms};
  else if (settings.budget_ms)
    policy.policy = BudgetPolicy{*settings.budget_ms};
  if (settings.budget_work && by_error)
    policy.policy = ErrorBudgetPolicy{.budget_work = *settings.budget_work};
  else if (settings.budget_work)
    policy.policy = WorkPolicy{*settings.budget_work};
  if (settings.full_within_m) policy.policy = DistancePolicy{.full_within = *settings.full_within_m};
  return policy;
}

Manager make_manager(const Scene& scene, const RunSettings& settings, const SignatureFunction& signatures) {
  Manager manager({.gravity = scene.step.gravity_m_per_s2,
                   .seed = scene.step.seed,
                   .threads = settings.threads,
                   .full_substeps = scene.step.full_substeps,
                   .model = settings.model ? settings.model : scene.model,
                   .tables = scene.tables,
                   .policy = policy_of(scene, settings),
                   .audit_ms = settings.audit_ms.value_or(scene.audit_ms),
                   .signatures = signatures});
  manager.materials() = scene.materials;
  for (const SceneGround& ground : scene.ground) {
    if (const auto* plane = std::get_if<GroundPlane>(&ground))
      manager.add_plane(plane->normal, plane->offset_m, plane->material);
    else if (const auto* box = std::get_if<GroundBox>(&ground))
      manager.add_static_box(box->sides_m, box->position_m, box->orientation, box->material);
    else
      manager.add_static_mesh(std::get<GroundMesh>(ground).mesh, std::get<GroundMesh>(ground).material);
  }
  return manager;
}

std::vector<BodyId> add_scene_bodies(Manager& manager, const Scene& scene, LevelChoice level) {
  std::vector<char> joined(scene.bodies.size());
  for (const SceneJoint& joint : scene.joints)
    for (const int body : {joint.first, joint.second})
      if (body != SceneJoint::kWorld) joined[std::size_t(body)] = true;
  std::vector<BodyId> bodies;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    BodyDefinition definition = scene.bodies[i].definition;
    if (level != LevelChoice::automatic && !joined[i]) definition.level = level;
    bodies.push_back(manager.add_body(definition));
    if (scene.bodies[i].asleep) manager.sleep(bodies.back());
  }
  const auto ode_body = [&](int body) {
    return body == SceneJoint::kWorld ? nullptr : manager.ode_body(bodies[std::size_t(body)]);
  };
  for (const SceneJoint& joint : scene.joints)
    join_bodies(ode_body(joint.first), ode_body(joint.second), joint.kind, joint.anchor_m, joint.axis);
  for (const std::vector<int>& group : scene.groups) {
    std::vector<BodyId> members;
    for (const int body : group) members.push_back(bodies[std::size_t(body)]);
    manager.make_group(members);
  }
  return bodies;
}

void move_viewpoints(Manager& manager, const Scene& scene, double time_s) {
  std::vector<Viewpoint> viewpoints;
  for (const SceneViewpoint& viewpoint : scene.viewpoints) {
    const Vec3 position = viewpoint.position_at(time_s), direction = viewpoint.look_at_m - position;
    const auto of_sight = direction.isZero(0.0) ? std::nullopt : std::optional(direction);
    viewpoints.push_back({.position = position,
                          .direction = of_sight,
                          .vertical_fov_rad = kFieldOfView,
                          .height_px = viewpoint.height_px,
                          .aspect = kAspectRatio});
  }
  manager.set_viewpoints(viewpoints);
}

}  // namespace lodestone
