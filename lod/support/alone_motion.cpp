// How a body moves that touches no other: flight and impacts, or a settling clip.
#include "lod/ground/met_ground.h"
#include "lod/statistical/flight.h"
#include "lod/support/hull_motion.h"
#include "lod/support/support_level.h"

namespace lodestone {

void SupportLevel::move_alone(std::int32_t slot, const FacesUnder& under, double time, ContactTally& tally,
                              const Quat* turned) {
  StatisticalBody& body = bodies_[std::size_t(slot)];
  body.placed = 0.0f;
  body.carried = false;
  const BodyKind& kind = kind_of(body);
  StepWorld step_world = world();
  step_world.planes = join_planes(ground_.planes(), under.faces);
  if (body.alone_on_solid) {
    if (!under.go_along) step_world.solids = &ground_;
    body.motion = Motion::dynamic;  // a clip plays on planes that stand still
  }
  const BodyProperties& own = properties_of(body);
  if (own.kinematic) {
    advance_kinematic(body, kind, time);
    return update_quiet(slot, under.faces, time, tally);
  }
  if (!own.gravity) step_world.gravity.setZero();
  const ActingForce& force = acting_.of(slot);  // for what moves alone, as good as a gravity of its own
  step_world.gravity += force.acceleration;
  step_world.turning = force.turning;
  step_world.planes = MetGround(ground_, own).of(step_world.planes);
  static const HullMotionSettings settings;
  const bool may_settle = moves_by_itself(own) && force.is_none() && !under.go_along;
  const HullMotion moved = move_on_hull(body, clips_[std::size_t(slot)], kind, step_world, settings_.gravity,
                                        time, may_settle, settings, turned);
  tally += moved.tally;
  if (moved.plays_clip) {
    if (moved.clip_over && settings_.sleeping) put_to_sleep(body);
    return;
  }
  update_quiet(slot, under.faces, time, tally);
}

}  // namespace lodestone
