// Bodies that touch other bodies: their pair contacts and ground contacts solved together, momentum exact to rounding. The paper's rule,
// in which each body of a pair responds as against an immovable plane (3.3.2), is kept as an option of `tables`.
#pragma once

#include <span>
#include <vector>

#include "lod/statistical/contact_memory.h"
#include "lod/statistical/ground_contact.h"
#include "lod/statistical/pair_contacts.h"
#include "lod/statistical/solid_contacts.h"
#include "lod/statistical/statistical_level.h"
#include "lod/statistical/tables_model.h"

namespace lodestone {

/// Who takes part in a pair: a slot of the level, or (negative) −1 − index of a full neighbour.
using Participant = std::int32_t;

struct CrowdContact {
  Participant first = 0, second = 0;
  PairContact contact;
};

struct CrowdSettings {
  ContactSolverSettings solver{.sweeps = 10, .tolerance = 1e-3};
  double contact_margin = 0.002;  ///< over R
};

/// Who may take part in a step, and where.
struct CrowdScene {
  std::span<StatisticalBody> bodies;
  std::span<const BodyKind> kinds;
  std::span<FullNeighbor> neighbors;
  std::span<const FullContact> full_contacts;
  const FacesBelow& faces;
  const StepWorld& world;
  StatisticalModel model = StatisticalModel::support;
  double time = 0.0;  ///< s

  const BodyKind& kind_of(std::int32_t slot) const { return kinds[bodies[std::size_t(slot)].kind]; }
  bool asleep(Participant p) const { return p >= 0 ? bodies[std::size_t(p)].motion == Motion::asleep : neighbors[std::size_t(-1 - p)].asleep; }
  MaterialId material_of(Participant p) const { return p >= 0 ? kind_of(p).material : neighbors[std::size_t(-1 - p)].material; }
  std::uint32_t owner_of(Participant p) const { return p >= 0 ? bodies[std::size_t(p)].owner : neighbors[std::size_t(-1 - p)].owner; }
  Vec3& position_of(Participant p) const { return p >= 0 ? bodies[std::size_t(p)].position : neighbors[std::size_t(-1 - p)].state.position; }
  SolverBody solver_body(Participant p) const;
};

/// The contact solver's work arrays, kept between steps so that a warm step allocates nothing.
class Crowd {
 public:
  explicit Crowd(JobRunner jobs = make_job_runner(1), const CrowdSettings& settings = {}) : settings_(settings), jobs_(std::move(jobs)) {}

  /// Solves `contacts`, those with static solids, the ground contacts of every crowded body (the scene's faces among them) and those of the scene's full contacts that
  /// hold up a full body, then moves the crowded bodies by the scene's time. Bodies asleep hold still; full neighbours receive impulses, the velocities that these give them,
  /// and shifts, but do not move on.
  ContactTally step(const CrowdScene& scene, std::span<const CrowdContact> contacts, std::span<const SolidContact> solid_contacts);

 private:
  void gather(const CrowdScene& scene, std::span<const CrowdContact> contacts, std::span<const SolidContact> solid_contacts);
  int solver_index(const CrowdScene& scene, Participant participant);
  void add_manifold(ContactKey key, std::int32_t first, std::int32_t second, const Vec3& normal, const ContactLaw& law);
  void add_point(const Vec3& arm_first, const Vec3& arm_second, double gap);
  void add_pair_contact(const CrowdScene& scene, const CrowdContact& pair);
  void add_solid_contact(const CrowdScene& scene, const SolidContact& on_solid);
  void add_ground_contacts(const CrowdScene& scene, int index, const HalfSpace& plane, std::size_t number);
  void sort_full_contacts(std::span<const FullContact> full_contacts, std::size_t neighbors);
  void add_full_contacts(const CrowdScene& scene, int index);
  void solve(const CrowdScene& scene);
  void move(const CrowdScene& scene);
  void give_to_full(std::span<FullNeighbor> neighbors) const;
  void move_apart(const CrowdScene& scene) const;
  void lift_off_ground(const CrowdScene& scene) const;

  CrowdSettings settings_;
  JobRunner jobs_;
  std::vector<Participant> participants_;     // of each solver body
  std::vector<std::int32_t> index_of_slot_, index_of_neighbor_;
  std::vector<std::int32_t> full_start_, full_next_, full_order_;  // of each neighbour: its run of full contacts
  std::vector<SolverBody> solver_bodies_;
  std::vector<Vec3> angular_before_;
  std::vector<CrowdManifold> manifolds_;
  std::size_t pair_manifolds_ = 0;            // the first of them
  std::vector<ContactKey> keys_;              // of each manifold
  std::vector<CrowdPoint> points_;
  CrowdSolver solver_;
  ContactMemory memory_;
};

/// The paper's rule for a pair of the statistical level (3.3.2).
void respond_pair_as_paper(StatisticalBody& first, const BodyKind& first_kind, StatisticalBody& second, const BodyKind& second_kind,
                           const PairContact& contact, const StepWorld& world, const ContactLaw& law, const TablesOptions& options, ContactTally& tally);

}  // namespace lodestone
