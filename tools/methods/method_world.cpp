#include "tools/methods/method_world.h"

#include "reference/error.h"

namespace lodestone {
namespace {

// What a body is to the engine that it is in.
OdeBodyDefinition body_of(const DropJob& job, const OdeMethod& way, const RigidState& state) {
  return {.shape = way.collision_shape,
          .mass = job.material.density * job.shape->volume,
          .state = state,
          .geometry = way.geometry,
          .spheres = way.spheres};
}

BodyDefinition body_of(const DropJob& job, const StatisticalMethod&, const RigidState& state) {
  return {.shape = job.shape, .state = state, .level = LevelChoice::statistical};
}

BulletBodyDefinition body_of(const DropJob& job, const BulletMethod& way, const RigidState& state) {
  return {.shape = job.shape,
          .mass = job.material.density * job.shape->volume,
          .material = job.material,
          .state = state,
          .geometry = way.geometry};
}

OdeWorld make_empty(const OdeMethod& way, const WorldSettings& settings, const MaterialTable& materials) {
  OdeSettings ode = way.settings;
  ode.gravity = settings.gravity;
  ode.seed = settings.seed;
  OdeWorld world(ode, materials);
  for (const HalfSpace& plane : settings.planes) world.add_plane(plane.normal, plane.offset, 0);
  for (const StaticBox& box : settings.solids.boxes)
    world.add_static_box(box.sides, box.center, Quat::Identity(), 0);
  for (const Mesh& mesh : settings.solids.meshes) world.add_static_mesh(mesh, 0);
  return world;
}

Manager make_empty(const StatisticalMethod& way, const WorldSettings& settings,
                   const MaterialTable& materials) {
  ManagerSettings manager = manager_settings_of(way, settings.seed);
  manager.gravity = settings.gravity;
  manager.threads = settings.threads;
  manager.sleeping = settings.sleeping;
  Manager world(manager);
  world.materials().replace(0, materials[0]);
  for (const HalfSpace& plane : settings.planes) world.add_plane(plane.normal, plane.offset);
  for (const StaticBox& box : settings.solids.boxes)
    world.add_static_box(box.sides, box.center, Quat::Identity());
  for (const Mesh& mesh : settings.solids.meshes) world.add_static_mesh(mesh);
  return world;
}

BulletWorld make_empty(const BulletMethod& way, const WorldSettings& settings,
                       const MaterialTable& materials) {
  if (!settings.solids.empty())
    throw_input_error("ground of bullet", "boxes or meshes", "planes, all that it is compared on");
  BulletSettings bullet = way.settings;
  bullet.gravity = settings.gravity;
  BulletWorld world(bullet);
  for (const HalfSpace& plane : settings.planes) world.add_plane(plane.normal, plane.offset, materials[0]);
  return world;
}

std::unique_ptr<MaterialTable> make_materials(const DropJob& job) {
  auto materials = std::make_unique<MaterialTable>();
  materials->replace(0, job.material);
  return materials;
}

}  // namespace

ManagerSettings manager_settings_of(const StatisticalMethod& method, std::uint64_t seed) {
  ManagerSettings settings;
  settings.seed = seed;
  settings.model = method.model;
  settings.tables.published = method.published;
  settings.signatures = [signature = method.signature](const Shape&, const ContactLaw&) { return signature; };
  return settings;
}

MethodWorld::World MethodWorld::make_world() const {
  if (const auto* ode = std::get_if<OdeMethod>(&method_.way))
    return Ode{make_empty(*ode, settings_, *materials_), {}};
  if (const auto* bullet = std::get_if<BulletMethod>(&method_.way))
    return Bullet{make_empty(*bullet, settings_, *materials_), {}};
  return Statistical{make_empty(std::get<StatisticalMethod>(method_.way), settings_, *materials_), {}};
}

MethodWorld::MethodWorld(const DropJob& job, const Method& method, const WorldSettings& settings,
                         std::span<const RigidState> starts)
    : job_(job), method_(method), settings_(settings), materials_(make_materials(job)), world_(make_world()) {
  fill(starts);
}

void MethodWorld::fill(std::span<const RigidState> starts) {
  const auto fill_one = [&](auto& filled, const auto& way) {
    for (const RigidState& start : starts)
      filled.bodies.push_back(filled.world.add_body(body_of(job_, way, start)));
  };
  if (auto* ode = std::get_if<Ode>(&world_))
    fill_one(*ode, std::get<OdeMethod>(method_.way));
  else if (auto* bullet = std::get_if<Bullet>(&world_))
    fill_one(*bullet, std::get<BulletMethod>(method_.way));
  else
    fill_one(std::get<Statistical>(world_), std::get<StatisticalMethod>(method_.way));
}

bool MethodWorld::empty() {
  const auto remove_all = [](auto& filled) {
    for (const auto body : filled.bodies) filled.world.remove_body(body);
    filled.bodies.clear();
    return true;
  };
  if (auto* ode = std::get_if<Ode>(&world_)) return remove_all(*ode);
  auto* statistical = std::get_if<Statistical>(&world_);
  return statistical && !settings_.solids.empty() && !std::get<StatisticalMethod>(method_.way).published &&
         remove_all(*statistical);
}

void MethodWorld::restart(std::uint64_t seed, std::span<const RigidState> starts) {
  settings_.seed = seed;
  if (!empty()) world_ = make_world();  // so that nothing of the last contacts is left
  fill(starts);
}

void MethodWorld::step(double dt) {
  if (auto* ode = std::get_if<Ode>(&world_))
    ode->world.step(dt, method_.substeps());
  else if (auto* bullet = std::get_if<Bullet>(&world_))
    bullet->world.step(dt);
  else
    std::get<Statistical>(world_).world.step(dt);
}

int MethodWorld::bodies() const {
  return std::visit([](const auto& filled) { return int(filled.bodies.size()); }, world_);
}

RigidState MethodWorld::state(int body) const {
  return std::visit([&](const auto& filled) { return filled.world.state(filled.bodies[std::size_t(body)]); },
                    world_);
}

bool MethodWorld::asleep(int body) const {
  return std::visit([&](const auto& filled) { return filled.world.asleep(filled.bodies[std::size_t(body)]); },
                    world_);
}

int MethodWorld::awake() const {
  int count = 0;
  for (int i = 0; i < bodies(); ++i) count += !asleep(i);
  return count;
}

const OdeWorld* MethodWorld::ode() const {
  const auto* ode = std::get_if<Ode>(&world_);
  return ode ? &ode->world : nullptr;
}

const Manager* MethodWorld::manager() const {
  const auto* statistical = std::get_if<Statistical>(&world_);
  return statistical ? &statistical->world : nullptr;
}

}  // namespace lodestone
