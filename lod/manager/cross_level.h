// Contacts between a full and a statistical body. The statistical level solves them, with the full bodies as
// they are at the start of the step and with what held them up in ODE's last substep; what they get from it
// is handed to ODE's bodies before the full level's step, so that momentum is kept to rounding.
#pragma once

#include <vector>

#include "lod/manager/levels.h"

namespace lodestone {

/// The full bodies, in the order of the full level's members, then the caller's, and the contacts among them,
/// joints counted in.
struct Neighborhood {
  std::vector<FullNeighbor> bodies;
  std::vector<FullContact> contacts;
  std::vector<dxBody*> ode_bodies;  // of each of the bodies

  /// A contact that ODE found, kept for some steps after: bodies at rest touch and part from substep to
  /// substep.
  struct Seen {
    OdeContact contact;
    int age = 0;  ///< steps
  };
  std::vector<Seen> seen;  // in order of their pairs
};

/// For a step of `dt` seconds. To be called while the bodies' forces are still held for them.
void gather(const Levels& levels, Neighborhood& neighborhood, double dt);

/// Gives each full body what came back, for a step of `dt` seconds that ODE takes in `substeps`, and lays
/// those still that are to fall asleep (of the full level's members).
void hand_over(Levels& levels, const Neighborhood& neighborhood, const std::vector<bool>& falls_asleep,
               double dt, int substeps);

}  // namespace lodestone
