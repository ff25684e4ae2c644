// Bodies that touch other bodies (a crowd): their contacts with each other and with the ground are solved
// together, with momentum exact to rounding.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "lod/contact/borne_weights.h"
#include "lod/contact/contact_memory.h"
#include "lod/contact/contact_scene.h"
#include "lod/contact/crowd_solver.h"
#include "lod/contact/footing.h"
#include "lod/contact/ground_meetings.h"
#include "lod/contact/solid_contacts.h"
#include "lod/jobs.h"
#include "reference/state_archive.h"

namespace lodestone {

struct CrowdContact {
  Participant first = Participant::ground(), second = Participant::ground();
  PairContact contact;

  void archive(StateArchive& a) { a(first, second, contact); }
};

struct CrowdSettings {
  double tolerance = 1e-3;        ///< see ContactSolverSettings
  double contact_margin = 0.002;  ///< over R
};

/// The contacts of a crowd in a substep of `time` seconds, and how they are solved.
struct CrowdTouch {
  std::span<const CrowdContact> contacts;
  std::span<const SolidContact> solid_contacts;
  std::span<const FullContact> full_contacts;
  const FacesBelow& faces;
  double time = 0.0;  ///< s
  /// s: a body that has been still for so long falls asleep if it stands firmly; larger ones later (RestLaw).
  float still_time = 1e30f;
  double still_speed = 0.0;  ///< m/s: what is slower moves no full body on (RestLaw)
  int sweeps = 10;           ///< of the solver, at most
  double parting = 1.0;      ///< factor of push_out_overlap, by which overlaps are undone
};

/// Solves a crowd. Its arrays are kept between steps, so that a warm step allocates nothing.
class Crowd {
 public:
  explicit Crowd(JobRunner jobs = make_job_runner(1), const CrowdSettings& settings = {})
      : settings_(settings), jobs_(std::move(jobs)) {}

  /// Solves the contacts of `touch` together with the ground contacts of every body in them (planes, and
  /// `faces`) and with the full contacts that hold up a full body in them. Sleepers hold still, and nothing
  /// moves yet. Must be followed by move() or drop().
  void solve(const ContactScene& scene, const CrowdTouch& touch);
  /// Sleepers that solve() held still though their weight and friction would not have held them.
  std::span<const Participant> pressed() const { return pressed_; }
  /// Undoes solve().
  void drop(const ContactScene& scene);
  /// After solve(): moves the statistical bodies by the touch's time. Full neighbours receive impulses, the
  /// velocities that these give them, and shifts, but do not move.
  ContactTally move(const ContactScene& scene, const CrowdTouch& touch);
  /// Frames a step. In it, sets of islands take their substeps one set after the other, each between
  /// begin_islands() and end_islands(); the first substep of each starts from the last step's impulses.
  void begin_step(double dt) { memory_.begin_step(dt), exchanges_.clear(); }
  void begin_islands() { memory_.begin_islands(); }
  void end_islands() { memory_.end_islands(); }
  void end_step() { memory_.end_step(); }
  /// What full neighbours gave each other since begin_step().
  std::span<const FullExchange> exchanges() const { return exchanges_; }
  void archive(StateArchive& a) { a(memory_); }
  void make_room(std::size_t bodies) { index_of_body_.resize(std::max(index_of_body_.size(), bodies), -1); }

 private:
  static constexpr std::int64_t kBlock = 128;  // bodies or contacts of a job

  /// The sum of a body's contact impulses (N s): solved, and as the solver started with them.
  struct Push {
    Vec3 now = Vec3::Zero(), before = Vec3::Zero();
    bool forced = false;  ///< a force acts on a body that it touches, perhaps through others
  };

  /// How far a body is moved out of overlaps that were brought from another rung.
  struct Parting {
    std::int32_t body = 0;
    Vec3 by = Vec3::Zero();  ///< m, sum over its overlaps
    double farthest = 0.0;   ///< m, by a single one at most
  };

  /// The overlap of a manifold, out of which bodies are moved.
  struct Overlap {
    Participant one, other;
    double radius = 0.0;     ///< m, with which its depth is compared
    double deep = 0.0;       ///< m: a greater depth is a good part of the thinner body's thickness
    double by_others = 0.0;  ///< m, by which other contacts with that ground have moved the first out
    bool eased = false;      ///< brought from another rung
  };

  /// A body that is so deep in another that it is not at rest.
  struct Insider {
    std::int32_t body = 0;
    Vec3 from = Vec3::Zero();  ///< m, where it was before it is moved out
    double asked = 0.0;        ///< m, by which both are to be moved
    float placed = 0.0f;       ///< s, StatisticalBody::placed: the longer of the two
  };

  void gather(const ContactScene& scene, const CrowdTouch& touch);
  void turn_carriers_half(double time);
  int solver_index(Participant participant);
  std::int32_t solver_index(const GroundPart& part);
  std::int32_t solver_index_of_ground(const Vec3& velocity);
  void add_manifold(ContactKey key, std::int32_t first, std::int32_t second, const Vec3& normal,
                    const ContactLaw& law);
  void add_point(const Vec3& arm_first, const Vec3& arm_second, double gap);
  void add_pair_contacts(const ContactScene& scene, std::span<const CrowdContact> contacts);
  void add_solid_contact(const ContactScene& scene, const SolidContact& on_solid);
  void take_bodies(const ContactScene& scene, std::size_t from, double time);
  void add_ground_contacts(const ContactScene& scene, std::int32_t index);
  void sort_full_contacts(std::span<const FullContact> full_contacts, std::size_t neighbors);
  void add_full_contacts(const ContactScene& scene, int index, const CrowdTouch& touch);
  void solve_gathered(const ContactScene& scene, const CrowdTouch& touch);
  void relieve_opposed();
  void note_presses(const ContactScene& scene, double time);
  std::size_t note_approaches(const ContactScene& scene, double time) const;
  void note_impulses(ContactLog& log, std::size_t known) const;
  template <class Visit>
  void each_participant(const Visit& visit) const {
    run_in_pieces(jobs_, std::int64_t(participants_.size()), kBlock,
                  [&](std::int64_t begin, std::int64_t end) {
                    for (std::int64_t i = begin; i < end; ++i) visit(std::size_t(i));
                  });
  }
  template <class Sleeps>
  void pass_forces_on(const ContactScene& scene, const Sleeps& sleeps);
  void find_pressed(const ContactScene& scene, double time);
  void find_footing(const ContactScene& scene, const CrowdTouch& touch);
  void find_impacts();
  void note_struck(const ContactScene& scene);
  double speed_of_blow(const CrowdManifold& m, const CrowdPoint& point) const;
  void move_bodies(const ContactScene& scene, double time);
  bool is_backed(std::size_t neighbor, const Vec3& impulse, const CrowdTouch& touch) const;
  void give_to_full(const ContactScene& scene, const CrowdTouch& touch);
  void move_apart(const ContactScene& scene, const CrowdTouch& touch);
  void note_overlap(const ContactScene& scene, const CrowdTouch& touch, const CrowdManifold& m,
                    const CrowdPoint& point, const Overlap& overlap);
  void undo_overlap(const ContactScene& scene, const CrowdTouch& touch, const CrowdManifold& m,
                    const CrowdPoint& point, const Overlap& overlap);
  bool can_move(std::int32_t solver_body) const;
  void shift(const ContactScene& scene, std::int32_t solver_body, const Vec3& by);
  void part_slowly(std::int32_t solver_body, const Vec3& by, double farthest);
  Vec3 shift_of(std::int32_t solver_body) const {
    return solver_body < 0 ? Vec3(Vec3::Zero()) : shifts_[std::size_t(solver_body)];
  }
  void keep_full_apart(const ContactScene& scene);
  void lift_off_ground(const ContactScene& scene, const CrowdTouch& touch) const;
  void keep_insiders_awake(const ContactScene& scene, double time);

  CrowdSettings settings_;
  JobRunner jobs_;
  std::vector<Participant> participants_;                        // of each solver body
  std::vector<std::int32_t> index_of_body_, index_of_neighbor_;  // in participants_; −1: not among them
  std::vector<std::int32_t> full_start_, full_next_,
      full_order_;  // of each neighbour: its run of full contacts
  std::vector<std::pair<const GroundPart*, std::int32_t>> moving_parts_;  // among solver_bodies_
  std::vector<std::pair<Vec3, std::int32_t>>
      moving_ground_;  // likewise, under full bodies: its velocities, m/s
  std::vector<SolverBody> solver_bodies_;
  std::vector<Vec3> angular_before_;
  std::vector<float>
      impact_time_;  // s, of each solver body: its first impact in the substep; none: not before its end
  std::vector<CrowdManifold> manifolds_;
  std::size_t pair_manifolds_ = 0;                        // the first of them
  std::vector<ContactKey> keys_;                          // of each manifold
  std::vector<std::pair<GroundId, MaterialId>> grounds_;  // that it is with, for the log
  std::vector<CrowdPoint> points_;
  std::vector<std::uint32_t> opposed_;  // manifolds that push against the next one: what a joint holds
  GroundMeetings meetings_;
  std::size_t noted_ = 0;  // contacts in the log before those at hand
  std::vector<Participant> pressed_;
  std::vector<FullExchange> exchanges_;
  std::vector<Push> pushes_;              // on each solver body
  std::vector<Parting> partings_;         // in this substep
  std::vector<std::int32_t> parting_of_;  // of each solver body; −1: none
  std::vector<Insider> insiders_;         // in this substep
  std::vector<Vec3> shifts_;              // m: of each solver body, out of overlaps in this substep
  CrowdSolver solver_;
  ContactMemory memory_;
  BorneWeights borne_weights_;
  Footing footing_;
  std::vector<double> radii_;  // m, of each solver body
};

}  // namespace lodestone
