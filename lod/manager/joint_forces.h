// What motors, limits and springs of joints do to full bodies, so that statistical bodies feel it through
// them: a press squeezes, a driven plate pushes on. What a joint holds is known beforehand
// (joint_contacts.h); of what it does besides ODE tells after its step, and it is taken to last.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lod/statistical/full_neighbor.h"
#include "reference/ode/joint_listener.h"
#include "reference/state_archive.h"

namespace lodestone {

class JointForces {
 public:
  /// Adds to the forces and torques of `neighbors` what their joints gave them lately.
  void add_to(std::span<FullNeighbor> neighbors) const;
  /// Around ODE's step of these; `bodies`: ODE's of each. Between the two nobody removes a body.
  void begin(std::span<const FullNeighbor> neighbors, std::span<dxBody* const> bodies);
  void end();
  void archive(StateArchive& a) { a(held_); }

 private:
  struct Held {
    std::uint32_t owner = 0;  // FullNeighbor::owner
    JointForce last,          // of the step before
        lasting;              // of the last two steps; what came in one alone was a blow
  };
  const Held* find(std::uint32_t owner) const;

  JointListener listener_;
  std::vector<std::uint32_t> listened_;  // owners
  std::vector<Held> held_;               // by ascending owner; of those that have any
};

}  // namespace lodestone
