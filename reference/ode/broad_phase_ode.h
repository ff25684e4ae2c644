// Which geoms may touch, in an order that depends on the scene alone.
#pragma once

#include <functional>
#include <vector>

#include "reference/ode/bodies_ode.h"
#include "reference/ode/box_tree.h"
#include "reference/ode/space_mirror.h"

namespace lodestone::ode {

/// Two geoms whose boxes overlap, at least one of which moves. `first` is always of a body of this world's.
struct Candidate {
  static constexpr std::uint64_t kGround = 1ull << 60, kCallers = 2ull << 60;

  dGeomID first, second;
  std::uint64_t first_order,
      second_order;  ///< slot of a body; the second's may be kGround + number or kCallers + the mirror's slot
  std::uint32_t first_part, second_part;  ///< of a body of several geoms

  bool with_ground() const { return second_order >= kGround && second_order < kCallers; }
  std::uint32_t second_number() const { return std::uint32_t(second_order & (kGround - 1)); }
};

Eigen::AlignedBox3d bounds_of(dGeomID geom);
Eigen::AlignedBox3d bounds_of(const Body& body);

/// Sweep and prune (ODE's; or its hash space) over this world's bodies, which stand by themselves, in no
/// space of the caller's; trees of the ground and of what the caller's space holds. Sleepers cost nothing but
/// where a body of the caller's comes near.
class BroadPhase {
 public:
  /// `callers`: null in a world of its own.
  BroadPhase(const SpaceMirror* callers, bool hash_space);
  ~BroadPhase();
  BroadPhase(const BroadPhase&) = delete;
  BroadPhase& operator=(const BroadPhase&) = delete;

  dSpaceID bodies_space() const { return bodies_space_; }

  void set_pair_filter(std::function<bool(OdeBodyId, OdeBodyId)> filter) { filter_ = std::move(filter); }
  /// By their bits and the filter.
  bool lets_meet(const Body& first, const Body& second) const;

  /// Ground of this world's, by its number (dGeomGetData). Adding wakes nobody.
  void add_ground(dGeomID geom);
  void remove_ground(dGeomID geom);
  void follow_ground(dGeomID geom, const Eigen::AlignedBox3d& before);

  /// Sorted; valid until the next call. Planes are not among them. The mirror has followed what moves
  /// (SpaceMirror::follow).
  std::span<const Candidate> find(Bodies& bodies);
  /// What a sleeper may touch besides who is awake: the ground, what the caller's space holds, and those
  /// other sleepers for which `wanted` holds; else likewise.
  std::span<const Candidate> find_of_sleeper(Bodies& bodies, const Body& body,
                                             const std::function<bool(const Body&)>& wanted);
  /// The ground and the caller's geoms, save planes, whose boxes meet `box` (m, world) and that a body of
  /// these bits meets; valid until the next call.
  std::span<const dGeomID> find_others(const Eigen::AlignedBox3d& box, const BodyProperties& properties);

  /// Wakes this world's bodies that overlap `box` (m, world) or nearly do.
  void wake_ours(Bodies& bodies, const Eigen::AlignedBox3d& box);
  /// Wakes the caller's, as the mirror saw them last.
  void wake_callers(const Eigen::AlignedBox3d& box);
  /// After each substep, and where one is put to sleep or woken.
  void note_sleep(const Body& body);
  void forget(const Body& body);  ///< that is about to be removed, or was put elsewhere

 private:
  static void meet_ours(void* self, dGeomID a, dGeomID b);
  void drop_filtered(Bodies& bodies);
  void find_around(const Body& body, std::uint64_t order);
  void find_sleepers_met();
  void add(const Candidate& candidate, unsigned category, unsigned collide);

  const SpaceMirror* callers_;
  std::function<bool(OdeBodyId, OdeBodyId)> filter_;
  dSpaceID bodies_space_;
  std::vector<dGeomID> ground_;  // by number; null where it was removed
  BoxTree ground_tree_;
  enum class Slept : char { no, near_here, here };
  BoxTree sleepers_;          // bodies that sleep, and some that slept
  std::vector<Slept> slept_;  // by slot: whether it is in the tree, and at its place
  Bodies* bodies_ = nullptr;  // while finding
  bool of_sleepers_ = false;  // while finding: of those that sleep
  std::vector<Candidate> candidates_;
  std::vector<dGeomID> others_;
  std::vector<std::uint32_t> found_;
};

}  // namespace lodestone::ode
