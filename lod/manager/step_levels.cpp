#include "lod/manager/step_levels.h"

#include <algorithm>

#include "lod/timing/stage_timer.h"

namespace lodestone {
namespace {

struct EndOfStep {
  JointForces& forces;
  ~EndOfStep() { forces.end(); }
};

}  // namespace

void StepLevels::step_statistical(double dt, WorldStepBy by, StepReport& report) {
  if (!levels_.statistical || levels_.statistical->size() == 0) {
    if (levels_.statistical) levels_.statistical->forget_contacts();
    neighborhood_.bodies.clear();
    neighborhood_.ode_bodies.clear();
    held_bodies_ = {};
    levels_.give_forces();
    return;
  }
  {
    const StageTimer timer(report.times.cross_level_ms);
    gather(levels_, neighborhood_, dt);
    held_bodies_.note_woken(neighborhood_);
    driven_bodies_.mark(neighborhood_, levels_.statistical_settings.gravity, dt);
    joint_forces_.add_to(neighborhood_.bodies);
    levels_.give_forces();
  }
  levels_.statistical->step(dt, neighborhood_.bodies, report, neighborhood_.contacts);
  const StageTimer timer(report.times.cross_level_ms);
  hand_over(levels_, neighborhood_, held_bodies_.find_still(levels_, neighborhood_, dt), dt,
            by == WorldStepBy::caller ? 1 : levels_.full.substeps_of(dt));
}

void StepLevels::step_full(double dt, StepReport& report) {
  const StageTimer timer(report.times.full_ms);
  levels_.eased.hold_back(levels_, dt);
  {
    joint_forces_.begin(neighborhood_.bodies, neighborhood_.ode_bodies);
    const EndOfStep end{joint_forces_};  // though ODE may give up
    levels_.full.step(dt, report.counters);
  }
  levels_.forget_places();
}

void StepLevels::begin_callers_step(double dt) {
  levels_.eased.hold_back(levels_, dt);
  joint_forces_.begin(neighborhood_.bodies, neighborhood_.ode_bodies);
  try {
    levels_.full.begin_callers_step(dt);
  } catch (...) {
    joint_forces_.end();
    throw;
  }
}

void StepLevels::end_callers_step(Counters& counters) {
  levels_.full.end_callers_step(counters);
  joint_forces_.end();
  levels_.forget_places();
}

void StepLevels::note_touching() {
  levels_.full.note_touching();
  for (std::size_t i = 0; i < std::min(neighborhood_.bodies.size(), levels_.full.members().size()); ++i)
    if (neighborhood_.bodies[i].is_touched()) levels_.full.note_touching(i);
}

}  // namespace lodestone
