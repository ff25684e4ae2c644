// What joints of full bodies hold and drive, as contacts among them, so that statistical bodies which one of
// them leans on bear what the joints bring onto it: a ragdoll's leg has its whole weight on it, a press that
// of its motor.
#pragma once

#include <span>
#include <vector>

#include "lod/statistical/full_neighbor.h"

struct dxBody;

namespace lodestone {

/// Appends two for each direction in which a joint holds or drives a body, without friction and against each
/// other. Kinematic bodies that are no neighbours count as ground that moves.
/// `bodies`: ODE's of each of the neighbours. To be asked outside of ODE's step.
void add_joint_contacts(std::span<const FullNeighbor> neighbors, std::span<dxBody* const> bodies,
                        std::vector<FullContact>& contacts);

}  // namespace lodestone
