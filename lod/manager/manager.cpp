#include "lod/manager.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "lod/manager/finish_report.h"
#include "lod/manager/move_bodies.h"
#include "lod/manager/step_levels.h"
#include "lod/manager/transfer.h"
#include "lod/timing/stage_timer.h"
#include "lod/timing/thread_clock.h"
#include "reference/error.h"
#include "reference/ode/static_planes.h"

namespace lodestone {
namespace {

StatisticalSettings statistical_settings(const ManagerSettings& settings, const Vec3& gravity) {
  return {.gravity = gravity,
          .seed = settings.seed,
          .threads = settings.threads,
          .jobs = settings.jobs,
          .tables = settings.tables,
          .sleeping = settings.sleeping};
}

FullSettings full_settings(const ManagerSettings& settings) {
  check_that(settings.full_substeps > 0, "full_substeps is positive:", std::to_string(settings.full_substeps));
  return {.gravity = settings.gravity, .seed = settings.seed, .substeps = settings.full_substeps, .sleeping = settings.sleeping};
}

/// A state that both levels can take; aborts where there is none.
RigidState checked(RigidState state) {
  const bool finite = state.position.allFinite() && state.velocity.allFinite() && state.angular_velocity.allFinite();
  check_that(finite && state.position.lpNorm<Eigen::Infinity>() <= 1e8, "a body's state is finite and within 1e8 m of the origin:",
             fmt::format("position {} {} {}", state.position.x(), state.position.y(), state.position.z()));
  const double norm = state.orientation.norm();
  check_that(std::abs(norm - 1.0) <= 1e-6, "an orientation has unit length:", fmt::format("length {}", norm));
  state.orientation.normalize();
  return state;
}

double checked_mass(const BodyDefinition& definition, const MaterialTable& materials) {
  check_that(definition.shape != nullptr, "a body has a shape");
  check_that(definition.material >= 0 && definition.material < materials.size(), "a body's material is in the table:",
             std::to_string(definition.material));
  check_that(definition.importance > 0.0, "a body's importance is positive:", std::to_string(definition.importance));
  const double mass = definition.mass.value_or(materials[definition.material].density * definition.shape->volume);
  check_that(mass > 0.0 && std::isfinite(mass), "a body's mass is positive:", std::to_string(mass));
  return mass;
}

/// Ground that the caller has in his own space, behind ours.
void read_callers_planes(dxSpace* space, std::size_t own_planes, std::vector<HalfSpace>& planes) {
  planes.resize(own_planes);
  for (const StaticPlane& plane : find_static_planes(space)) planes.push_back({plane.normal, plane.offset, 0});
}

/// Of a statistical stage that took `ms` in all.
void add_statistical(const Levels& levels, double ms, StepMeasurement& measured) {
  if (levels.statistical && levels.statistical->size() > 0) {
    measured.rungs_ms[std::size_t(Rung::tables)] = levels.statistical->cost().tables_ms;
    measured.rungs_ms[std::size_t(Rung::support)] = levels.statistical->cost().support_ms;
  }
  measured.others_ms += std::max(0.0, ms - measured.total_of_rungs_ms());
}

}  // namespace

std::string_view name_of(Rung rung) { return std::array{"tables", "support", "full"}[std::size_t(rung)]; }

/// The bodies and the stages of a step, in their order.
struct Manager::Impl {
  explicit Impl(const ManagerSettings& s)
      : levels(statistical_settings(s, s.gravity), full_settings(s), SignatureStore(s.signatures, s.signature_timing)), choose(levels, s.policy, s.model) {}
  Impl(dxWorld* world, dxSpace* space, const ManagerSettings& s)
      : levels(world, space, statistical_settings(s, gravity_of(world)), full_settings(s), SignatureStore(s.signatures, s.signature_timing)),
        choose(levels, s.policy, s.model),
        callers_space(space) {}

  Levels levels;
  CostModel costs;
  Choose choose;
  MoveBodies move_bodies{levels, choose};
  StepLevels step_levels{levels};
  StepReport report;
  dxSpace* callers_space = nullptr;
  std::size_t own_planes = 0;  // those of the caller's space follow in levels.ground
};

Manager::Manager(const ManagerSettings& settings) : impl_(std::make_unique<Impl>(settings)) {}
Manager::Manager(dxWorld* world, dxSpace* space, const ManagerSettings& settings)
    : impl_(std::make_unique<Impl>(world, space, settings)) {}
Manager::~Manager() = default;
Manager::Manager(Manager&&) noexcept = default;
Manager& Manager::operator=(Manager&&) noexcept = default;

MaterialTable& Manager::materials() { return impl_->levels.materials; }

void Manager::add_plane(const Vec3& normal, double offset, MaterialId material) {
  check_that(std::abs(normal.norm() - 1.0) <= 1e-6 && std::isfinite(offset), "a plane has a unit normal and a finite offset:",
             fmt::format("normal {} {} {}, offset {}", normal.x(), normal.y(), normal.z(), offset));
  const HalfSpace plane{normal.normalized(), offset, material};
  auto& planes = impl_->levels.ground.planes;
  planes.insert(planes.begin() + std::ptrdiff_t(impl_->own_planes++), plane);
  impl_->levels.full.add_plane(plane);
}

void Manager::add_static_mesh(const Mesh& mesh, MaterialId material) {
  Eigen::AlignedBox3d bounds;
  for (const Vec3& vertex : mesh.vertices) bounds.extend(vertex);
  impl_->choose.add_static_bounds(bounds);
  impl_->levels.ground.solids.add_mesh(mesh, material);
  impl_->levels.full.add_static_mesh(mesh, material);
}

void Manager::add_static_box(const Vec3& sides, const Vec3& position, const Quat& orientation, MaterialId material) {
  const Vec3 reach = orientation.toRotationMatrix().cwiseAbs() * (0.5 * sides);
  impl_->choose.add_static_bounds({position - reach, position + reach});
  impl_->levels.ground.solids.add_box(sides, position, orientation, material);
  impl_->levels.full.add_static_box(sides, position, orientation, material);
}

BodyId Manager::add_body(const BodyDefinition& definition) {
  Levels& levels = impl_->levels;
  const double mass = checked_mass(definition, levels.materials);
  BodyDefinition normalized = definition;
  normalized.state = checked(definition.state);
  const BodyId body = levels.bodies.add(normalized, mass);
  if (definition.level == LevelChoice::full) {
    place(levels, body.index, Rung::full);
    levels.bodies.forget_last_newcomer();
  }
  return body;
}

void Manager::remove_body(BodyId body) {
  take_out(impl_->levels, impl_->levels.bodies.index_of(body));
  impl_->levels.bodies.remove(body);
  impl_->move_bodies.forget(body.index);
  impl_->choose.forget(body.index);
}

void Manager::set_level(BodyId body, LevelChoice choice) {
  BodyTable& bodies = impl_->levels.bodies;
  bodies.set_choice(bodies.index_of(body), choice);
  impl_->choose.note(body.index);
}

void Manager::set_policy(const PolicySettings& policy) { impl_->choose.set_policy(policy); }

void Manager::set_viewpoints(std::span<const Vec3> positions) {
  for (const Vec3& position : positions) check_that(position.allFinite(), "a viewpoint is finite");
  impl_->choose.set_viewpoints(positions);
}

void Manager::set_state(BodyId body, const RigidState& state) {
  const std::uint32_t index = impl_->levels.bodies.index_of(body);
  const RigidState sound = checked(state);
  impl_->levels.set_state(index, sound);
  impl_->choose.note(index);
}

void Manager::add_force(BodyId body, const Vec3& force, const Vec3& torque) {
  check_that(force.allFinite() && torque.allFinite(), "force and torque are finite");
  const std::uint32_t index = impl_->levels.bodies.index_of(body);
  impl_->levels.bodies.add_force(index, {force, torque});
  impl_->levels.wake(index);
}

const StepReport& Manager::step(double dt) {
  check_that(dt > 0.0 && dt <= 0.1, "a step lasts more than 0 and at most 0.1 s:", std::to_string(dt));
  Impl& stages = *impl_;
  Levels& levels = stages.levels;
  StepReport& report = stages.report;
  report = {.step = report.step + 1, .times = {}, .counters = report.counters};
  levels.now = report.step;
  const auto& policy = stages.choose.policy().policy;
  const bool budgeted = !std::holds_alternative<DistancePolicy>(policy), clocked = std::holds_alternative<BudgetPolicy>(policy);
  const std::optional<double> budget_ms = clocked ? std::optional(std::get<BudgetPolicy>(policy).budget_ms) : std::nullopt;
  if (levels.statistical) levels.statistical->set_clocked(clocked);
  StepMeasurement measured;
  ThreadLaps laps(clocked);
  {
    const StageTimer timer(report.times.total_ms);
    // 1 choose rungs
    stages.move_bodies.count_down_retries();
    const std::optional<RungChanges> changes = stages.choose.run(report, stages.costs);
    // 2 transfer
    if (stages.callers_space) read_callers_planes(stages.callers_space, stages.own_planes, levels.ground.planes);
    levels.ground.solids.prepare();
    if (changes) stages.move_bodies.run(*changes, report);
    if (budgeted) stages.choose.count_meetings();
    measured.others_ms += laps.lap_ms();
    // 3 statistical rungs and their contacts with full bodies
    stages.step_levels.step_statistical(dt, report);
    add_statistical(levels, laps.lap_ms(), measured);
    // 4 full level
    stages.step_levels.step_full(dt, report);
    measured.rungs_ms[std::size_t(Rung::full)] = laps.lap_ms();
  }
  // 5 report
  report_bodies(levels, report);
  if (!budgeted) return report;
  stages.step_levels.note_touching();
  measured.others_ms += laps.lap_ms();
  report_cost(levels, stages.choose.counts(), measured, budget_ms, stages.costs, report);
  return report;
}

int Manager::bodies() const { return impl_->levels.bodies.size(); }
bool Manager::valid(BodyId body) const { return impl_->levels.bodies.valid(body); }
RigidState Manager::state(BodyId body) const { return impl_->levels.state(impl_->levels.bodies.index_of(body)); }
double Manager::mass(BodyId body) const { return impl_->levels.bodies[impl_->levels.bodies.index_of(body)].mass; }
const Shape& Manager::shape(BodyId body) const {
  return *impl_->levels.bodies.shape(impl_->levels.bodies.index_of(body));
}
Level Manager::level(BodyId body) const { return level_of(rung(body)); }
Rung Manager::rung(BodyId body) const { return impl_->levels.bodies.level(impl_->levels.bodies.index_of(body)).rung; }
bool Manager::asleep(BodyId body) const { return impl_->levels.asleep(impl_->levels.bodies.index_of(body)); }
dxBody* Manager::ode_body(BodyId body) const {
  const BodyRecord& record = impl_->levels.bodies[impl_->levels.bodies.index_of(body)];
  return record.ode ? impl_->levels.full.world()->ode_body(record.ode) : nullptr;
}
const StepReport& Manager::report() const { return impl_->report; }
std::size_t Manager::statistical_bytes() const { return impl_->levels.statistical ? impl_->levels.statistical->bytes() : 0; }

std::string Manager::why(BodyId body) const {
  const std::uint32_t index = impl_->levels.bodies.index_of(body);
  const BodyLevel& level = impl_->levels.bodies.level(index);
  if (level.newcomer) return "at no level yet: the next step chooses one";
  return fmt::format("{}: {}", name_of(level.rung), text_of(level.reason));
}

std::uint64_t Manager::state_hash() const {
  const Levels& levels = impl_->levels;
  std::uint64_t hash = 0;
  for (const std::uint32_t body : levels.bodies.in_order_of_creation()) {
    const auto [x, q, v, w] = levels.state(body);
    const bool full(levels.bodies[body].ode), asleep = levels.asleep(body);
    const std::array<double, 15> numbers{x.x(), x.y(), x.z(), q.w(), q.x(), q.y(), q.z(), v.x(),
                                         v.y(), v.z(), w.x(), w.y(), w.z(), double(full), double(asleep)};
    hash = XXH64(numbers.data(), sizeof numbers, hash);
  }
  return hash;
}

}  // namespace lodestone
