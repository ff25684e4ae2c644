#include "lod/full/full_level.h"

#include <algorithm>

namespace lodestone {
namespace {

// Overlap, say of bodies that were added on top of each other, is pushed apart at walking pace and not at depth × ERP / h.
constexpr double kMaxCorrectingVelocity = 1.0;

// dWorldStep is the truth's law, but its time grows with the cube of the contacts that hang together: a large pile is QuickStep's.
constexpr int kDirectContactsMax = 150;
constexpr int kQuickStepIterations = 60;  // ODE's own 20 let a pile of a few layers sink into the floor

// Two bunnies deep in each other else take up to 40 ms in one substep, and nothing can be foretold of a step with two of them.
constexpr int kMostMeshMeasures = 600;

// At shorter substeps ODE's own contacts with planes are as near to the truth as two batches of truth to each other.
constexpr double kTimedContactsAbove = 7e-4;  // s

}  // namespace

OdeSettings ode_settings_of(const FullSettings& settings) {
  return {.gravity = settings.gravity,
          .seed = settings.seed,
          .quick_step_iterations = kQuickStepIterations,
          .direct_contacts_max = kDirectContactsMax,
          .max_correcting_velocity = kMaxCorrectingVelocity,
          .most_mesh_measures = kMostMeshMeasures,
          .plane_depth_max = kPlaneDepthMax,
          .timed_contacts_above = kTimedContactsAbove,
          .auto_disable = settings.sleeping};
}

FullLevel::FullLevel(const FullSettings& settings, const MaterialTable& materials) : settings_(settings), materials_(&materials) {}

FullLevel::FullLevel(dxWorld* world, dxSpace* space, const FullSettings& settings, const MaterialTable& materials)
    : settings_(settings), materials_(&materials), world_(std::in_place, world, space, ode_settings_of(settings), materials) {}

void FullLevel::lay(std::function<void(OdeWorld&)> ground) {
  if (world_) ground(*world_);
  else waiting_ground_.push_back(std::move(ground));
}

void FullLevel::add_plane(const HalfSpace& plane) {
  lay([plane](OdeWorld& world) { world.add_plane(plane.normal, plane.offset, plane.material); });
}

void FullLevel::add_static_box(const Vec3& sides, const Vec3& position, const Quat& orientation, MaterialId material) {
  lay([=](OdeWorld& world) { world.add_static_box(sides, position, orientation, material); });
}

void FullLevel::add_static_mesh(const Mesh& mesh, MaterialId material) {
  lay([mesh, material](OdeWorld& world) { world.add_static_mesh(mesh, material); });
}

OdeBodyId FullLevel::add(std::uint32_t owner, const OdeBodyDefinition& definition, bool asleep) {
  if (!world_) {
    world_.emplace(ode_settings_of(settings_), *materials_);
    for (const auto& ground : waiting_ground_) ground(*world_);
    waiting_ground_.clear();
  }
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

std::int32_t FullLevel::index_of(OdeBodyId body) const {
  const auto found = index_of_id_.find(body.value);
  return found == index_of_id_.end() ? -1 : found->second;
}

void FullLevel::step(double dt, Counters& counters) {
  if (!world_) return;
  world_->step(dt, settings_.substeps);
  add_new_counts(counters);
}

void FullLevel::note_touching() {
  touching_.assign(members_.size(), false);
  if (!world_) return;
  for (const OdeContact& contact : world_->contacts()) {
    const std::int32_t first = index_of(contact.first), second = contact.second ? index_of(contact.second) : -1;
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
  return int(std::ranges::count_if(members_, [this](const Member& member) { return world_->asleep(member.id); }));
}

}  // namespace lodestone
