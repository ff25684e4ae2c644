// The inside of the statistical level. Its stages are in near_pairs.cpp (1, 2), motion.cpp (3) and rest.cpp (5);
// crowded_motion.cpp takes stages 2 to 4 in substeps; stage 4, the contact solver, is crowd.h.
#pragma once

#include "lod/statistical/clip_player.h"
#include "lod/statistical/crowd.h"
#include "lod/statistical/pair_memory.h"
#include "lod/statistical/statistical_level.h"
#include "lod/broad_phase/cell_grid.h"
#include "lod/broad_phase/still_grid.h"

namespace lodestone {

struct Push { Vec3 force = Vec3::Zero(), torque = Vec3::Zero(); };

/// Two bodies whose bounding balls meet in this step: places among those that move (the awake by place, then full neighbours), or −1 − the slot of a sleeper.
struct NearPair {
  std::int32_t first = 0, second = 0;
};

/// How fast a body turns.
struct Turning {
  Vec3 angular_velocity = Vec3::Zero();  ///< rad/s, world
  double rim_speed = 0.0;                ///< m/s: of the point farthest from the centre about it
};

/// What is known of a near pair. A gap lasts until its bodies have moved by it, so most near pairs need no look at their hulls (conservative advancement;
/// Mirtich, Impulse-based dynamic simulation of rigid body systems, 1996); a contact lasts while they move little.
struct FoundPair {
  ContactKey key = 0;
  Participant first = 0, second = 0;
  double gap = 0.0;                ///< m, at least, when it was found
  std::optional<PairPose> when;    ///< how the bodies lay then; none: never
  HullGap whole = {.normal = Vec3::Zero()};  ///< as the two after it, see find_pair_contacts
  std::vector<KnownGap> of_pieces;
  std::vector<HeldContact> contacts;

  void forget() {
    when.reset();
    whole = {.normal = Vec3::Zero()};
    of_pieces.clear();
    contacts.clear();
  }
};

struct StatisticalLevel::Impl {
  StatisticalSettings settings;
  const StaticGround& ground;
  const MaterialTable& materials;
  JobRunner jobs;
  std::vector<BodyKind> kinds;

  // One of each per body, by slot.
  std::vector<StatisticalBody> bodies;
  std::vector<ClipPlayback> clips;
  std::vector<std::optional<Vec3>> angular_velocity_given;  // until the next step: a state that was set is read back to the bit
  std::vector<std::int32_t> given;           // slots of these
  std::vector<Vec3> last_places;  // at the step's start
  std::vector<std::pair<int, Push>> pushes;  // of the next step

  std::vector<std::int32_t> awake;           // slots
  std::vector<char> lies_still;              // by slot: sleeps since an earlier step, and is in `still`; in no loop
  std::int64_t asleep_count = 0;
  StillGrid still;
  bool woken = false;                        // one of them, since near pairs were found
  CellGrid cells;                            // of those that move
  PairMemory pair_memory;                    // places in found_before
  Crowd crowd;
  double reach = 0.0;
  std::int64_t steps = 0;
  bool pair_phase = false;                   // in this step

  // Work arrays of a step.
  std::vector<double> ball_x, ball_y, ball_z;  // m: bounding balls of those that move, grown by how far they may in this step
  std::vector<float> ball_reach;             // m
  BallPairs ball_pairs;
  std::vector<std::int32_t> still_near;      // sleepers near one that moves
  std::vector<std::int32_t> movers;          // awake slots, by place
  std::vector<NearPair> pairs;
  std::vector<char> near_another;            // by slot: of those that may touch another in this step
  std::vector<Turning> turning;              // by slot; none of those that sleep
  std::vector<FullNeighbor> full, full_before;  // the neighbours, moved on between substeps
  std::vector<FoundPair> spare_found;
  std::vector<FoundPair> found, found_before;  // of the pairs of this step and of the last one
  std::vector<const FoundPair*> following;   // of which neither gains on the other
  std::vector<CrowdContact> contacts;
  std::vector<std::uint32_t> first_contact;  // of each found pair, among those that are looked at
  std::vector<char> may_close;                // of each of these
  std::vector<SolidContact> solid_contacts;
  FacesBelow faces_below;
  std::vector<ContactTally> tallies;

  Impl(const StatisticalSettings& s, const StaticGround& g, const MaterialTable& m)
      : settings(s), ground(g), materials(m), jobs(s.jobs ? s.jobs : make_job_runner(s.threads)), crowd(jobs) {}

  const BodyKind& kind_of(const StatisticalBody& body) const { return kinds[body.kind]; }
  std::uint16_t find_kind(std::shared_ptr<const Shape> shape, double mass, MaterialId material, std::shared_ptr<const Signature> signature);
  StepWorld world() const { return {settings.gravity, &ground, &materials, settings.seed}; }

  void wake(int slot);
  void put_to_sleep(StatisticalBody& body);
  void lay_still(std::int32_t slot);    ///< a sleeper leaves all loops
  void take_from_still(std::int32_t slot);
  void sort_by_motion();

  void apply_pushes(double dt, ContactTally& tally);
  void find_near_pairs(double dt, std::span<const FullNeighbor> neighbors);
  void find_contacts(double dt, std::span<const FullNeighbor> neighbors);
  void remember_places();
  void find_turning();
  double find_approach(const FoundPair& pair, double dt, std::span<const FullNeighbor> neighbors) const;
  double gap_left(const FoundPair& pair, std::span<const FullNeighbor> neighbors) const;
  double least_radius(const FoundPair& pair, std::span<const FullNeighbor> neighbors) const;
  PairBody pair_body(Participant p, std::span<const FullNeighbor> neighbors) const;
  void sort_by_place(std::vector<std::int32_t>& slots) const;
  void add_ball(const Vec3& position, const Vec3& velocity, double radius, double dt);
  void find_still_pairs();
  Participant participant(std::int32_t of_pair) const;
  void resize_found(std::size_t count);
  void take_over_found(std::span<const FullNeighbor> neighbors);
  void find_contact(double dt, std::span<const FullNeighbor> neighbors, FoundPair& pair) const;
  bool closes(const FoundPair& pair, const PairContact& contact, double dt, std::span<const FullNeighbor> neighbors) const;
  Vec3 center_velocity(Participant p, std::span<const FullNeighbor> neighbors) const;
  Vec3 point_velocity(Participant p, const Vec3& point, std::span<const FullNeighbor> neighbors) const;
  bool is_asleep(Participant p, std::span<const FullNeighbor> neighbors) const {
    return p < 0 ? neighbors[-1 - p].asleep : bodies[p].motion == Motion::asleep;
  }
  void find_ground_solids(double dt, bool of_near_only);  ///< near: as mark_near has it
  void wake_touched(std::span<FullNeighbor> neighbors);
  void move(double dt, std::span<FullNeighbor> neighbors, std::span<const FullContact> full_contacts, StageTimes& times, ContactTally& tally);
  void move_crowded(double dt, double time, std::span<FullNeighbor> neighbors, std::span<const FullContact> full_contacts, ContactTally& tally);
  template <class Select>
  ContactTally move_those(double time, Select select);
  int plan_substeps(double dt);
  void mark_near(const FoundPair& pair);
  bool may_strike_ground(std::int32_t slot, double dt) const;
  double mark_followers(double dt);
  void move_alone(std::size_t place, double dt, ContactTally& tally);  ///< place in `awake`
  const StaticGround& ground_below(std::int32_t slot) const;
  void move_support(StatisticalBody& body, int slot, const StaticGround& over, double dt, ContactTally& tally);
  void update_quiet(StatisticalBody& body, double dt, ContactTally& tally);
  bool stands_firmly(const StatisticalBody& body) const;
  bool is_sound(const StatisticalBody& body, double energy) const;
  void recover(StatisticalBody& body, ContactTally& tally);
};

}  // namespace lodestone
