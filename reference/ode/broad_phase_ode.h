// Which geoms may touch, in an order that depends on the scene alone.
#pragma once

#include <vector>

#include "reference/ode/bodies_ode.h"

namespace lodestone::ode {

/// Two geoms whose boxes overlap, not both at rest. `first` is always of a body of this world's.
struct Candidate {
  dGeomID first, second;
  std::uint64_t first_order, second_order;  ///< slot, or a number beyond every slot for ground and the caller's geoms
  std::uint32_t first_part, second_part;    ///< of a body of several geoms
};

/// Sweep and prune (ODE's; or its hash space) over this world's bodies, then those against the ground and against the caller's space.
class BroadPhase {
 public:
  /// `around`: the caller's space, or null. Ours is put into it, hidden (no category, nothing to collide with), so that the caller's
  /// own dSpaceCollide does not meet it.
  BroadPhase(dSpaceID around, bool hash_space);
  ~BroadPhase();
  BroadPhase(const BroadPhase&) = delete;
  BroadPhase& operator=(const BroadPhase&) = delete;

  dSpaceID bodies_space() const { return bodies_space_; }
  dSpaceID ground_space() const { return ground_space_; }

  /// Sorted; valid until the next call.
  std::span<const Candidate> find(Bodies& bodies);
  /// The ground and the caller's geoms, save planes, whose boxes meet `box` (m, world); valid until the next call.
  std::span<const dGeomID> find_others(const Eigen::AlignedBox3d& box);
  /// Wakes every body whose box meets that of `geom`.
  void wake_around(dGeomID geom);

 private:
  static void meet(void* self, dGeomID a, dGeomID b);
  void add(dGeomID a, dGeomID b);
  void collect(dSpaceID space, const Eigen::AlignedBox3d& box);

  dSpaceID around_, bodies_space_, ground_space_;
  Bodies* bodies_ = nullptr;  // while finding
  std::vector<Candidate> candidates_;
  std::vector<dGeomID> others_;
};

}  // namespace lodestone::ode
