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

 private:
  struct Held {
    dBodyID body;
    Vec3 force, torque;
  };
  void note(dBodyID body);
  void note_jointed();

  std::vector<dBodyID> included_, jointed_;
  std::vector<Held> held_;
};

}  // namespace lodestone::ode
