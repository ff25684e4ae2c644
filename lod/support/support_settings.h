// What the `support` model is set to: how far its impacts and contact steps may be from exact.
#pragma once

#include "lod/contact/contact_solver.h"

namespace lodestone {

struct SupportSettings {
  int max_impacts = 4;  ///< exact impacts a step; what is left of the step is done in contact steps
  /// Cheaper, for `tables`: small turns are taken to second order, and in contact_at_once.h velocities are
  /// those of a step's end, not half a step behind.
  bool coarse = false;
  double contact_step = 0.07;     ///< longest contact step over √(R/g)
  double uneven_step = 0.045;     ///< the same over ground that is no plane
  double step_at_once = 0.07;     ///< the same of an angular hull on planes (contact_at_once.h)
  double contact_margin = 0.002;  ///< over R: vertices this near the ground can carry
  /// Over √(gR): what goes faster along the ground, and than friction can stop, slides.
  double sliding_speed = 0.04;
  ContactSolverSettings solver{.sweeps = 8, .tolerance = 1e-2, .frictionless_bound = true};
  /// No contact step, and no lift out of the ground, adds energy: without, a body of many vertices that rocks
  /// is kept rocking by those that sink in.
  bool energy_bounded = true;
  double impact_tolerance = 1e-4;  ///< over R: how far off the ground an impact may be taken
  double impact_margin = 1e-6;     ///< over R: vertices this near the one that strikes strike with it
  /// Over √(R/g): so do those that it would take so long to strike. In ODE, the truth, a curved surface
  /// strikes with all that has sunk in within a step (4e-3): the bunny's first rebound is then .13 off
  /// instead of .17. More is worse for the armadillo's dense points.
  double impact_lag = 7e-4;
  double greatest_impact_margin = 0.01;  ///< over R
  /// Of what strikes at once; a post that comes down upright needs most sweeps, or it is tilted by what is
  /// left.
  ContactSolverSettings impact_solver{.sweeps = 200, .frictionless_bound = true};

  /// Of bodies of `tables` that move on their hulls and must come to rest by themselves. Friction is bounded
  /// by each impulse as it is: with `support`'s bound two of two hundred rocked for ten seconds and more,
  /// since in longer steps, while they are less slow, they lose less.
  static SupportSettings of_tables() {
    SupportSettings settings;
    settings.solver.frictionless_bound = false;
    settings.step_at_once = 0.0;  // by it one of ten thousand boxes still moves after a minute
    return settings;
  }
};

}  // namespace lodestone
