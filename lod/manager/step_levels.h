// Stages 3 and 4 of a step: the statistical rungs and their contacts with full bodies, then the full level
// with what came of those contacts.
#pragma once

#include "lod/manager/cross_level.h"
#include "lod/manager/driven_bodies.h"
#include "lod/manager/held_bodies.h"
#include "lod/manager/joint_forces.h"
#include "lod/manager/levels.h"
#include "lod/step_report.h"
#include "reference/state_archive.h"

namespace lodestone {

/// Who advances the world of the full bodies: the manager, in its substeps, or the caller, in one step.
enum class WorldStepBy { manager, caller };

class StepLevels {
 public:
  explicit StepLevels(Levels& levels) : levels_(levels) {}

  void step_statistical(double dt, WorldStepBy by, StepReport& report);
  void step_full(double dt, StepReport& report);
  /// The two in place of step_full(), around the step that the caller takes of its world.
  void begin_callers_step(double dt);
  void end_callers_step(Counters& counters);
  /// Notes which full bodies touch another, on whatever rung; after both stages.
  void note_touching();
  void archive(StateArchive& a) { a(neighborhood_.seen, joint_forces_, driven_bodies_, held_bodies_); }

 private:
  Levels& levels_;
  Neighborhood neighborhood_;
  JointForces joint_forces_;
  DrivenBodies driven_bodies_;
  HeldBodies held_bodies_;
};

}  // namespace lodestone
