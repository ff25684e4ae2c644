// The `support` model: the hull's exact support height and contact point, one closed-form frictional impulse
// per impact at its exact time, and a small multi-contact solver while the body slides, rolls or rocks. It
// takes the place of the sphere and the response tables of section 3.3; resting follows in settling clips
// (clip_player.h).
#pragma once

#include "lod/contact/contact_solver.h"
#include "lod/statistical/step_world.h"

namespace lodestone {

struct SupportSettings {
  int max_impacts = 4;            ///< exact impacts a step; what is left of the step is done in contact steps
  double contact_step = 0.05;     ///< longest contact step over √(R/g)
  double contact_margin = 0.002;  ///< over R: vertices this near the ground can carry
  ContactSolverSettings solver{.sweeps = 8, .tolerance = 1e-2, .frictionless_bound = true};
  bool timed_bounces =
      true;  ///< what strikes within a contact step leaves as fast as it would at its own time
  bool energy_bounded = true;  ///< no contact step, and no lift out of the ground, adds energy: without, a
                               ///< body of many vertices that rocks is kept rocking by those that sink in
  double impact_tolerance = 1e-4;  ///< over R: how far off the ground an impact may be taken
  double impact_margin = 1e-6;     ///< over R: vertices this near the one that strikes strike with it
  double impact_lag =
      7e-4;  ///< over √(R/g): so do those that it would take so long to strike. In ODE, the truth, a curved
             ///< surface strikes with all that has sunk in within a step (4e-3): the bunny's first rebound is
             ///< then .13 off instead of .17. More is worse for the armadillo's dense points.
  double greatest_impact_margin = 0.01;  ///< over R
  ContactSolverSettings impact_solver{.sweeps = 40, .frictionless_bound = true};

  /// Of bodies of `tables` that move on their hulls and must come to rest by themselves. Friction is bounded
  /// by each impulse as it is: with `support`'s bound two of two hundred rocked for ten seconds and more,
  /// since in longer steps, while they are less slow, they lose less.
  static SupportSettings of_tables() {
    SupportSettings settings;
    settings.solver.frictionless_bound = false;
    return settings;
  }
};

/// Moves a body that touches no other by `time` seconds over the ground's planes. `turned`: how it is turned
/// after them if it flies so long, where that is known (TurnLanes).
ContactTally step_support_body(StatisticalBody& body, const BodyKind& kind, const StepWorld& world,
                               double time, const SupportSettings& settings, const Quat* turned = nullptr);

}  // namespace lodestone
