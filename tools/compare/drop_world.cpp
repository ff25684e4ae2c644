#include "tools/compare/drop_world.h"

#include <cmath>

#include "reference/random.h"
#include "tools/compare/method_bodies.h"

namespace lodestone {
namespace {

constexpr double kFarApart = 60.0;  // sizes of a body: farther than any drop goes

Manager make_manager(const DropJob& job, const StatisticalMethod& method, std::uint64_t seed) {
  Manager manager(manager_settings_of(method, seed));
  manager.materials().replace(0, job.material);
  manager.add_plane(drop_plane_normal(job.conditions), 0.0);
  return manager;
}

// Draws are keyed by (seed, body, event), and the body is the first of its manager: each drop needs a seed of
// its own.
std::uint64_t seed_of_drop(std::uint64_t seed, std::uint32_t trial) {
  RandomStream random(seed, trial, 0x5eed);
  return std::uint64_t(random.uniform() * 0x1p53);
}

}  // namespace

DropWorld::DropWorld(const DropJob& job, const DropMethod& method)
    : job_(job), method_(method), materials_(std::make_unique<MaterialTable>()) {
  materials_->replace(0, job.material);
}

void DropWorld::start(std::uint64_t seed, std::uint32_t trial) {
  const RigidState state = drop_state(*job_.shape, job_.conditions, seed, trial);
  if (std::holds_alternative<OdeMethod>(method_.way))
    start_ode(state);
  else if (std::holds_alternative<BulletMethod>(method_.way))
    start_bullet(state);
  else
    start_statistical(state, seed, trial);
}

void DropWorld::start_ode(const RigidState& state) {
  const auto& way = std::get<OdeMethod>(method_.way);
  if (ode_) {
    ode_->world.remove_body(ode_->body);
  } else {
    ode_.emplace(OdeWorld(way.settings, *materials_), OdeBodyId{});
    ode_->world.add_plane(drop_plane_normal(job_.conditions), 0.0, 0);
  }
  ode_->body = ode_->world.add_body(ode_body_of(job_, way, state));
}

void DropWorld::start_bullet(const RigidState& state) {
  bullet_.emplace(BulletWorld({}), -1);  // anew, so that nothing of the last drop's contacts is left
  bullet_->world.add_plane(drop_plane_normal(job_.conditions), 0.0, job_.material);
  bullet_->body = bullet_->world.add_body(bullet_body_of(job_, std::get<BulletMethod>(method_.way), state));
}

void DropWorld::start_statistical(const RigidState& state, std::uint64_t seed, std::uint32_t trial) {
  Manager manager = make_manager(job_, std::get<StatisticalMethod>(method_.way), seed_of_drop(seed, trial));
  const BodyId body = manager.add_body(statistical_body_of(job_, state));
  statistical_.emplace(std::move(manager), body);
}

void DropWorld::step(double dt) {
  if (ode_)
    ode_->world.step(dt, method_.substeps());
  else if (bullet_)
    bullet_->world.step(dt);
  else
    statistical_->manager.step(dt);
}

RigidState DropWorld::state() const {
  if (bullet_) return bullet_->world.state(bullet_->body);
  return ode_ ? ode_->world.state(ode_->body) : statistical_->manager.state(statistical_->body);
}

std::int64_t DropWorld::table_extrapolations() const {
  return statistical_ ? statistical_->manager.report().counters.table_extrapolations : 0;
}

Manager make_many_drops(const DropJob& job, const StatisticalMethod& method, std::uint64_t seed, int bodies) {
  Manager manager = make_manager(job, method, seed);
  const Vec3 across = Vec3::UnitY(), along = across.cross(drop_plane_normal(job.conditions));
  const int side = int(std::ceil(std::sqrt(double(bodies))));
  for (int i = 0; i < bodies; ++i) {
    RigidState state = drop_state(*job.shape, job.conditions, seed, i);
    state.position +=
        kFarApart * job.shape->size * ((i % side - side / 2) * across + (i / side - side / 2) * along);
    manager.add_body(statistical_body_of(job, state));
  }
  return manager;
}

}  // namespace lodestone
