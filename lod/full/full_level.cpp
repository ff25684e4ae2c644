#include "lod/full/full_level.h"

#include <fmt/format.h>

#include <algorithm>

#include "reference/ode/callers_bodies.h"
#include "reference/simulation_error.h"
#include "reference/state_archive.h"

namespace lodestone {
namespace {

// Overlap, say of bodies that were added on top of each other, is pushed apart at walking pace and not at
// depth × ERP / h.
constexpr double kMaxCorrectingVelocity = 1.0;
// What is left of a frame may be a step of any length: in one of 1e-4 s a heap at rest is given 65 J.
constexpr double kCorrectingTime = 1.0 / 960.0;  // s

// dWorldStep is the truth's law, but its time grows with the cube of the contacts that hang together: a large
// pile is QuickStep's. By that a ball goes on at 3.0 m/s that has struck boxes of a hundredth of its weight,
// and by dWorldStep at 2.3.
constexpr int kDirectContactsMax = 60, kUnevenDirectContactsMax = 150;
constexpr int kQuickStepIterations = 60;  // ODE's own 20 let a pile of a few layers sink into the floor
constexpr double kQuickStepLayer = 0.3;   // g h²; with .1 one heap of a hundred in three goes on shaking

// Two bunnies deep in each other else take up to 40 ms in one substep, and nothing can be foretold of a step
// with two of them.
constexpr int kMostMeshMeasures = 600;

// At shorter substeps ODE's own contacts with planes are as near to the truth as two batches of truth to each
// other.
constexpr double kTimedContactsAbove = 7e-4;  // s

// ODE knows a contact once bodies overlap. Plates that overlap by more than half are parted the wrong way,
// and a blow goes through a stack by one plate a substep while the others fall on (20 of 4 mm, in 4 substeps:
// energy × 4).
constexpr double kThin = 0.05;     // inner radius over radius; of a box .2 × .3 × .4 m it is .37
constexpr int kThinSubsteps = 16;  // of thin bodies that are awake among others

}  // namespace

OdeSettings ode_settings_of(const FullSettings& settings) {
  return {.gravity = settings.gravity,
          .seed = settings.seed,
          .quick_step_iterations = kQuickStepIterations,
          .quick_step_layer = kQuickStepLayer,
          .direct_contacts_max = kDirectContactsMax,
          .uneven_direct_contacts_max = kUnevenDirectContactsMax,
          .max_correcting_velocity = kMaxCorrectingVelocity,
          .correcting_time = kCorrectingTime,
          .slides_straight = true,
          .most_mesh_measures = kMostMeshMeasures,
          .plane_depth_max = kPlaneDepthMax,
          .timed_contacts_above = kTimedContactsAbove,
          .auto_disable = settings.sleeping,
          .sleep = {settings.sleep.speed, settings.sleep.speed, 5.0 * settings.sleep.time}};
}

FullLevel::FullLevel(const FullSettings& settings, const MaterialTable& materials)
    : settings_(settings), materials_(&materials) {}

FullLevel::FullLevel(dxWorld* world, dxSpace* space, const FullSettings& settings,
                     const MaterialTable& materials)
    : settings_(settings),
      materials_(&materials),
      world_(std::in_place, world, space, ode_settings_of(settings), materials) {
  settings_.gravity = callers::gravity(world);
}

void FullLevel::add_ground(GroundId id, std::function<OdeGroundId(OdeWorld&)> make) {
  piece_of_[id.index] = pieces_.insert(pieces_.end(), Piece{.id = id, .make = std::move(make)});
  if (world_) lay(pieces_.back());
}

void FullLevel::lay(Piece& piece) {
  piece.laid = piece.make(*world_);
  piece.make = {};
  if (piece.moved) world_->move_ground(piece.laid, *piece.moved);
  id_of_laid_[piece.laid.value] = piece.id;
}

void FullLevel::add_plane(GroundId id, const HalfSpace& plane) {
  add_ground(
      id, [plane](OdeWorld& world) { return world.add_plane(plane.normal, plane.offset, plane.material); });
}

void FullLevel::add_static_box(GroundId id, const Vec3& sides, const Vec3& position, const Quat& orientation,
                               MaterialId material) {
  add_ground(id,
             [=](OdeWorld& world) { return world.add_static_box(sides, position, orientation, material); });
}

void FullLevel::add_static_mesh(GroundId id, const Mesh& mesh, MaterialId material) {
  add_ground(id, [mesh, material](OdeWorld& world) { return world.add_static_mesh(mesh, material); });
}

void FullLevel::move_ground(GroundId id, const RigidState& state) {
  Piece& piece = *piece_of_.at(id.index);
  if (world_)
    world_->move_ground(piece.laid, state);
  else
    piece.moved = state;
}

void FullLevel::remove_ground(GroundId id) {
  const auto piece = piece_of_.at(id.index);
  if (world_) {
    world_->remove_ground(piece->laid);
    id_of_laid_.erase(piece->laid.value);
  }
  pieces_.erase(piece);
  piece_of_.erase(id.index);
}

void FullLevel::go_on(double gone) {
  gone_ = gone;
  if (world_) world_->go_on(gone);
}

GroundId FullLevel::ground_of(OdeGroundId id) const {
  const auto known = id_of_laid_.find(id.value);
  return known == id_of_laid_.end() ? GroundId{} : known->second;
}

void FullLevel::set_pair_filter(std::function<bool(std::uint32_t, std::uint32_t)> filter) {
  pair_filter_ = std::move(filter);
  if (world_) filter_pairs();
}

void FullLevel::filter_pairs() {
  if (!pair_filter_) return world_->set_pair_filter({});
  const auto owner = [this](OdeBodyId body) { return members_[std::size_t(index_of(body))].owner; };
  world_->set_pair_filter(
      [this, owner](OdeBodyId a, OdeBodyId b) { return pair_filter_(owner(a), owner(b)); });
}

void FullLevel::make_world() {
  world_.emplace(ode_settings_of(settings_), *materials_);
  for (Piece& piece : pieces_) lay(piece);
  if (gone_ > 0.0) world_->go_on(gone_);
  if (pair_filter_) filter_pairs();
}

void FullLevel::set_gravity(const Vec3& gravity) {
  settings_.gravity = gravity;
  if (world_) callers::set_gravity(world_->ode_world(), gravity);
}

OdeBodyId FullLevel::add(std::uint32_t owner, const OdeBodyDefinition& definition, bool asleep) {
  if (!world_) make_world();
  const OdeBodyId body = world_->add_body(definition);
  if (asleep) world_->set_asleep(body, true);
  index_of_id_[body.value] = std::int32_t(members_.size());
  members_.push_back({owner, body});
  touching_.push_back(false);
  return body;
}

void FullLevel::remove(OdeBodyId body, bool stays) {
  world_->remove_body(body, stays);
  // Swapped with the last: order does not matter to ODE, and is the same in every run.
  const std::int32_t index = index_of(body);
  members_[index] = members_.back();
  index_of_id_[members_[index].id.value] = index;
  members_.pop_back();
  touching_[std::size_t(index)] = touching_.back();
  touching_.pop_back();
  index_of_id_.erase(body.value);
}

void FullLevel::archive(StateArchive& a) {
  bool has_world = world_.has_value();
  a(has_world);
  if (has_world && !world_) make_world();
  if (has_world)
    world_->archive(a);
  else if (world_)
    world_->begin_anew();
  a(members_, touching_);
  if (!a.reading()) return;
  index_of_id_.clear();
  for (std::size_t i = 0; i < members_.size(); ++i) index_of_id_[members_[i].id.value] = std::int32_t(i);
  if (world_) counted_ = world_->counters();
}

std::int32_t FullLevel::index_of(OdeBodyId body) const {
  const auto found = index_of_id_.find(body.value);
  return found == index_of_id_.end() ? -1 : found->second;
}

void FullLevel::step(double dt, Counters& counters) {
  if (!world_) return;
  try {
    world_->step(dt, substeps_of(dt));
  } catch (const SimulationError& error) {
    const std::int32_t index = error.body() ? index_of(OdeBodyId{*error.body()}) : -1;
    if (index < 0) throw SimulationError(error.what());
    const std::uint32_t owner = members_[std::size_t(index)].owner;
    throw SimulationError(fmt::format("{}: body {}", error.what(), owner), owner);
  }
  add_new_counts(counters);
}

int FullLevel::substeps_of(double dt) const {
  return may_thin_meet(dt) ? std::max(settings_.substeps, kThinSubsteps) : settings_.substeps;
}

/// Whether a thin body that is awake may meet another within `dt` seconds. By a sweep along the axis on which
/// the bodies lie furthest apart.
bool FullLevel::may_thin_meet(double dt) const {
  const auto is_thin_awake = [this](OdeBodyId body) {
    const Shape& shape = world_->shape(body);
    return shape.inner_radius < kThin * shape.radius && !world_->asleep(body);
  };
  if (std::ranges::none_of(members_, is_thin_awake, &Member::id)) return false;
  struct Way {
    Vec3 position, velocity;
    double radius, reach;  // m; reach: in dt, from the position
    bool thin_awake;
  };
  std::vector<Way> ways;
  Eigen::AlignedBox3d all;
  const double fall = 0.5 * settings_.gravity.norm() * dt * dt;
  for (const Member& member : members_) {
    const RigidState state = world_->state(member.id);
    const double radius = world_->shape(member.id).radius;
    ways.push_back({state.position, state.velocity, radius, radius + 0.5 * fall + state.velocity.norm() * dt,
                    is_thin_awake(member.id)});
    all.extend(state.position);
  }
  Eigen::Index axis = 0;
  all.sizes().maxCoeff(&axis);
  const auto low = [axis](const Way& way) { return way.position[axis] - way.reach; };
  std::ranges::sort(ways, {}, low);
  for (auto a = ways.begin(); a != ways.end(); ++a)
    for (auto b = a + 1; b != ways.end() && low(*b) < a->position[axis] + a->reach; ++b) {
      const double reach = a->radius + b->radius + fall + (a->velocity - b->velocity).norm() * dt;
      if ((a->thin_awake || b->thin_awake) && (a->position - b->position).squaredNorm() < reach * reach)
        return true;
    }
  return false;
}

void FullLevel::begin_callers_step(double dt) { world_->begin_callers_step(dt); }

void FullLevel::end_callers_step(Counters& counters) {
  world_->end_callers_step();
  add_new_counts(counters);
}

void FullLevel::note_touching() {
  touching_.assign(members_.size(), false);
  if (!world_) return;
  for (const OdeContact& contact : world_->contacts()) {
    const std::int32_t first = index_of(contact.first),
                       second = contact.second ? index_of(contact.second) : -1;
    if (first < 0 || second < 0) continue;
    touching_[std::size_t(first)] = touching_[std::size_t(second)] = true;
  }
}

void FullLevel::add_new_counts(Counters& counters) {
  const OdeCounters& now = world_->counters();
  counters.ode_bodies_created += now.bodies_created - counted_.bodies_created;
  counters.trimeshes_built += now.trimeshes_built - counted_.trimeshes_built;
  counters.ode_messages += now.messages - counted_.messages;
  counters.contacts_dropped += now.contacts_dropped - counted_.contacts_dropped;
  counters.full_quick_steps += now.quick_steps - counted_.quick_steps;
  counters.full_passes_prevented += now.passes_prevented - counted_.passes_prevented;
  counters.full_uneven_contacts += now.uneven_contacts - counted_.uneven_contacts;
  counters.full_swallowed += now.swallowed - counted_.swallowed;
  counters.states_recovered += now.states_recovered - counted_.states_recovered;
  counted_ = now;
}

int FullLevel::asleep_count() const {
  return int(
      std::ranges::count_if(members_, [this](const Member& member) { return world_->asleep(member.id); }));
}

}  // namespace lodestone
