// Forces that the caller gave bodies before a step (dBodyAdd…, the motors of joints), which ODE forgets with
// each of its own: held over all substeps, as gravity is.
#pragma once

#include <vector>

#include "reference/ode/bodies_ode.h"
#include "reference/ode/space_mirror.h"

namespace lodestone::ode {

class HeldForces {
 public:
  /// Bodies of the caller's that have neither geoms in his space nor joints with one that has.
  void include(dBodyID body) { included_.push_back(body); }
  void exclude(dBodyID body) { std::erase(included_, body); }

  /// Notes what acts now on this world's bodies, those of the caller's that are in `mirror` (null: none) or
  /// were included, and what hangs on them by joints.
  void note(dWorldID world, Bodies& bodies, const SpaceMirror* mirror);
  /// Before each substep.
  void give() const;

  /// Notes where those of the caller's are, so that a substep can be taken back.
  void note_states();
  void take_back() const;

 private:
  struct Held {
    dBodyID body;
    Vec3 force, torque;
  };
  struct Before {
    dBodyID body;
    RigidState state;
    bool enabled;
  };
  void note(dBodyID body);
  void note_callers(dBodyID body);
  void note_jointed(Bodies& bodies);

  std::vector<dBodyID> included_, jointed_, callers_;
  std::vector<Held> held_;
  std::vector<Before> before_;  // of callers_
};

}  // namespace lodestone::ode
