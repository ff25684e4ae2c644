// How a body moves that touches no other: flight and impacts, or a settling clip.
#include <algorithm>

#include "lod/statistical/flight.h"
#include "lod/support/support_level.h"
#include "lod/support/support_model.h"

namespace lodestone {
namespace {

// It rocks on the ground for as long as the clip plays.
ContactRecord touch_of_clip(const StatisticalBody& body, const HalfSpace& ground) {
  return {.first = body.owner, .ground = ground.id, .ground_material = ground.material, .point = body.position - ground.height_of(body.position) * ground.normal, .normal = ground.normal};
}

}  // namespace

void SupportLevel::move_alone(std::int32_t slot, std::span<const HalfSpace> faces, double time, ContactTally& tally) {
  StatisticalBody& body = bodies_[std::size_t(slot)];
  ClipPlayback& clip = clips_[std::size_t(slot)];
  const BodyKind& kind = kind_of(body);
  const double gravity = settings_.gravity.norm();
  static const ClipSettings clip_settings;
  static const SupportSettings support_settings;
  StepWorld step_world = world();
  step_world.planes = join_planes(ground_.planes(), faces);
  const BodyProperties& own = properties_of(body);
  if (own.kinematic) {
    advance_kinematic(body, kind, time);
    return update_quiet(slot, faces, time, tally);
  }
  if (!own.gravity) step_world.gravity.setZero();
  if (!meets_ground(own)) step_world.planes = {};
  // A clip plays on its own ground only: that of a static solid ends at an edge.
  const auto same = [&](const HalfSpace& plane) { return plane.normal == clip.ground.normal && plane.offset == clip.ground.offset; };
  if (body.motion == Motion::settling && std::ranges::none_of(step_world.planes, same)) body.motion = Motion::dynamic;
  if (body.motion == Motion::settling) {
    if (log_) log_->add(touch_of_clip(body, clip.ground));
    if (advance_clip(clip, body, kind, gravity, time, clip_settings) && settings_.sleeping) put_to_sleep(body);
    return;
  }
  tally = step_support_body(body, kind, step_world, time, support_settings);
  if (tally.touched_plane < 0) return update_quiet(slot, faces, time, tally);
  const HalfSpace& plane = step_world.planes[std::size_t(tally.touched_plane)];
  if (kind.clips && !kind.clips->empty() && step_world.is_horizontal(plane) && moves_by_itself(own)) {
    if (const auto joined = find_clip(body, kind, plane, gravity, clip_settings)) {
      clip = *joined;
      body.motion = Motion::settling;
      return;
    }
  }
  update_quiet(slot, faces, time, tally);
}

}  // namespace lodestone
