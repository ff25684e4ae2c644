#include "tools/bench/table1_world.h"

#include <xxhash.h>

#include <algorithm>
#include <array>
#include <chrono>

#include "lod/timing/thread_clock.h"
#include "tools/bench/heap_memory.h"
#include "tools/bench/table1_job.h"

namespace lodestone {
namespace {

// Plain ODE, as the table's baselines are set: QuickStep with 20 iterations, eight contacts a pair, nothing
// of ours.
OdeSettings baseline_settings(const Table1WorldSettings& settings) {
  return {.seed = settings.seed,
          .quick_step = true,
          .quick_step_iterations = 20,
          .bounce_velocity = 0.2,
          .friction_along_slip = false,
          .max_contacts_per_pair = 8,
          .mesh_contacts = MeshContacts::plain,
          .plane_contacts_from_hull = false,
          .hash_space = settings.hash_space,
          .auto_disable = settings.sleeping};
}

OdeSettings full_settings(OdeSettings ours, const Table1WorldSettings& settings) {
  ours.seed = settings.seed;
  ours.hash_space = settings.hash_space;
  ours.auto_disable = settings.sleeping;
  return ours;
}

// The name says which: `full` and full_N are our full level.
bool is_baseline(const DropMethod& method) {
  return method.name == "full_plain" || !method.name.starts_with("full");
}

}  // namespace

Table1World::Table1World(const DropJob& job, const DropMethod& method, const Table1WorldSettings& settings)
    : heap_before_(heap_bytes()),
      settings_(settings),
      method_(method),
      materials_(std::make_unique<MaterialTable>()) {
  materials_->replace(0, job.material);
  if (const auto* ode = std::get_if<OdeMethod>(&method.way))
    make_ode(job, *ode);
  else if (const auto* bullet = std::get_if<BulletMethod>(&method.way))
    make_bullet(job, *bullet);
  else
    make_statistical(job, std::get<StatisticalMethod>(method.way));
}

void Table1World::make_ode(const DropJob& job, const OdeMethod& way) {
  const OdeSettings ode =
      is_baseline(method_) ? baseline_settings(settings_) : full_settings(way.settings, settings_);
  ode_.emplace(OdeWorld(ode, *materials_), std::vector<OdeBodyId>());
  ode_->world.add_plane(Vec3::UnitZ(), 0.0, 0);
  for (int i = 0; i < settings_.bodies; ++i)
    ode_->bodies.push_back(ode_->world.add_body({.shape = way.collision_shape,
                                                 .mass = job.material.density * job.shape->volume,
                                                 .state = table1_start(i, settings_.bodies, settings_.seed),
                                                 .geometry = way.geometry,
                                                 .spheres = way.spheres}));
}

void Table1World::make_bullet(const DropJob& job, const BulletMethod& way) {
  bullet_.emplace(BulletSettings{.bounce_velocity = 0.2, .sleeping = settings_.sleeping});
  bullet_->add_plane(Vec3::UnitZ(), 0.0, job.material);
  for (int i = 0; i < settings_.bodies; ++i)
    bullet_->add_body({.shape = job.shape,
                       .mass = job.material.density * job.shape->volume,
                       .material = job.material,
                       .state = table1_start(i, settings_.bodies, settings_.seed),
                       .geometry = way.geometry});
}

void Table1World::make_statistical(const DropJob& job, const StatisticalMethod& way) {
  ManagerSettings manager;
  manager.seed = settings_.seed;
  manager.threads = settings_.threads;
  manager.sleeping = settings_.sleeping;
  manager.model = way.model;
  manager.tables.published = way.published;
  manager.signatures = [signature = way.signature](const Shape&, const ContactLaw&) { return signature; };
  statistical_.emplace(Manager(manager), std::vector<BodyId>());
  statistical_->manager.materials().replace(0, job.material);
  statistical_->manager.add_plane(Vec3::UnitZ(), 0.0);
  BodyDefinition body;
  body.shape = job.shape;
  body.level = LevelChoice::statistical;
  for (int i = 0; i < settings_.bodies; ++i) {
    body.state = table1_start(i, settings_.bodies, settings_.seed);
    statistical_->bodies.push_back(statistical_->manager.add_body(body));
  }
}

StepMs Table1World::step(double dt) {
  StepMs ms;
  const double processor_start = thread_time_ms();
  const auto start = std::chrono::steady_clock::now();
  if (ode_)
    ode_->world.step(dt, method_.substeps());
  else if (bullet_)
    bullet_->step(dt);
  else
    statistical_->manager.step(dt);
  ms.step = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  if (settings_.threads == 1) ms.step = std::min(ms.step, thread_time_ms() - processor_start);
  if (ode_) {
    ms.collision = ode_->world.times().collision_ms;
    ms.response = ode_->world.times().response_ms;
  } else if (statistical_) {
    const StageTimes& times = statistical_->manager.report().times;
    ms.collision = times.broad_phase_ms + times.pairs_ms;
    ms.response = times.flight_ms + times.crowd_ms;
    ms.rest = times.rest_ms;
    ms.bytes_moved = statistical_->manager.report().bytes_moved;
  }
  return ms;
}

RigidState Table1World::state(int body) const {
  if (ode_) return ode_->world.state(ode_->bodies[body]);
  if (bullet_) return bullet_->state(body);
  return statistical_->manager.state(statistical_->bodies[body]);
}

bool Table1World::asleep(int body) const {
  if (ode_) return ode_->world.asleep(ode_->bodies[body]);
  if (bullet_) return bullet_->asleep(body);
  return statistical_->manager.asleep(statistical_->bodies[body]);
}

int Table1World::awake() const {
  int count = 0;
  for (int i = 0; i < settings_.bodies; ++i) count += !asleep(i);
  return count;
}

std::uint64_t Table1World::state_hash() const {
  std::uint64_t hash = 0;
  for (int i = 0; i < settings_.bodies; ++i) {
    const auto [x, q, v, w] = state(i);
    const std::array<double, 13> numbers{x.x(), x.y(), x.z(), q.w(), q.x(), q.y(), q.z(),
                                         v.x(), v.y(), v.z(), w.x(), w.y(), w.z()};
    hash = XXH64(numbers.data(), sizeof numbers, hash);
  }
  return hash;
}

double Table1World::level_bytes_per_body() const {
  return statistical_ ? double(statistical_->manager.statistical_bytes()) / settings_.bodies : 0.0;
}

double Table1World::bytes_per_body() const { return (heap_bytes() - heap_before_) / settings_.bodies; }

}  // namespace lodestone
