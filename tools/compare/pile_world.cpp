#include "tools/compare/pile_world.h"

#include "tools/compare/method_bodies.h"

namespace lodestone {

PileSurroundings make_bin(double side) {
  PileSurroundings bin;
  bin.planes.push_back({Vec3::UnitZ(), 0.0});
  for (const Vec3& inward : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)})
    bin.planes.push_back({inward, -0.5 * side});
  return bin;
}

PileSurroundings make_empty_space() { return {.gravity = Vec3::Zero(), .sleeping = false}; }

PileWorld::PileWorld(const DropJob& job, const DropMethod& method, const PileSurroundings& surroundings,
                     std::span<const RigidState> starts, std::uint64_t seed)
    : substeps_(method.substeps()), materials_(std::make_unique<MaterialTable>()) {
  materials_->replace(0, job.material);
  if (const auto* way = std::get_if<OdeMethod>(&method.way))
    fill_ode(job, *way, surroundings, starts, seed);
  else if (const auto* statistical = std::get_if<StatisticalMethod>(&method.way))
    fill_statistical(job, *statistical, surroundings, starts, seed);
  else
    fill_bullet(job, std::get<BulletMethod>(method.way), surroundings, starts);
}

void PileWorld::fill_ode(const DropJob& job, const OdeMethod& way, const PileSurroundings& surroundings,
                         std::span<const RigidState> starts, std::uint64_t seed) {
  OdeSettings settings = way.settings;
  settings.gravity = surroundings.gravity;
  settings.seed = seed;
  ode_.emplace(OdeWorld(settings, *materials_), std::vector<OdeBodyId>{});
  for (const HalfSpace& plane : surroundings.planes) ode_->world.add_plane(plane.normal, plane.offset, 0);
  for (const RigidState& start : starts)
    ode_->bodies.push_back(ode_->world.add_body(ode_body_of(job, way, start)));
}

void PileWorld::fill_statistical(const DropJob& job, const StatisticalMethod& way,
                                 const PileSurroundings& surroundings, std::span<const RigidState> starts,
                                 std::uint64_t seed) {
  ManagerSettings settings = manager_settings_of(way, seed);
  settings.gravity = surroundings.gravity;
  settings.sleeping = surroundings.sleeping;
  statistical_.emplace(Manager(settings), std::vector<BodyId>{});
  statistical_->manager.materials().replace(0, job.material);
  for (const HalfSpace& plane : surroundings.planes)
    statistical_->manager.add_plane(plane.normal, plane.offset);
  for (const RigidState& start : starts)
    statistical_->bodies.push_back(statistical_->manager.add_body(statistical_body_of(job, start)));
}

void PileWorld::fill_bullet(const DropJob& job, const BulletMethod& way, const PileSurroundings& surroundings,
                            std::span<const RigidState> starts) {
  bullet_.emplace(BulletWorld({.gravity = surroundings.gravity}), std::vector<int>{});
  for (const HalfSpace& plane : surroundings.planes)
    bullet_->world.add_plane(plane.normal, plane.offset, job.material);
  for (const RigidState& start : starts)
    bullet_->bodies.push_back(bullet_->world.add_body(bullet_body_of(job, way, start)));
}

void PileWorld::step(double dt) {
  if (ode_)
    ode_->world.step(dt, substeps_);
  else if (bullet_)
    bullet_->world.step(dt);
  else
    statistical_->manager.step(dt);
}

int PileWorld::bodies() const {
  if (ode_) return int(ode_->bodies.size());
  return bullet_ ? int(bullet_->bodies.size()) : int(statistical_->bodies.size());
}

RigidState PileWorld::state(int body) const {
  if (ode_) return ode_->world.state(ode_->bodies[std::size_t(body)]);
  if (bullet_) return bullet_->world.state(bullet_->bodies[std::size_t(body)]);
  return statistical_->manager.state(statistical_->bodies[std::size_t(body)]);
}

int PileWorld::awake() const {
  return statistical_ ? bodies() - statistical_->manager.report().asleep : bodies();
}

}  // namespace lodestone
