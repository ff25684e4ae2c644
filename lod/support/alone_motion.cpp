// How a body moves that touches no other: flight and impacts, or a settling clip.
#include <algorithm>

#include "lod/support/support_level.h"
#include "lod/support/support_model.h"

namespace lodestone {

void SupportLevel::move_alone(std::int32_t slot, std::span<const HalfSpace> faces, double time, ContactTally& tally) {
  StatisticalBody& body = bodies_[std::size_t(slot)];
  ClipPlayback& clip = clips_[std::size_t(slot)];
  const BodyKind& kind = kind_of(body);
  const double gravity = settings_.gravity.norm();
  static const ClipSettings clip_settings;
  static const SupportSettings support_settings;
  StepWorld step_world = world();
  thread_local StaticGround with_faces;
  if (!faces.empty()) {
    with_faces.planes = ground_.planes;
    with_faces.planes.insert(with_faces.planes.end(), faces.begin(), faces.end());
    step_world.ground = &with_faces;
  }
  // A clip plays on its own ground only: that of a static solid ends at an edge.
  const auto same = [&](const HalfSpace& plane) { return plane.normal == clip.ground.normal && plane.offset == clip.ground.offset; };
  if (body.motion == Motion::settling && std::ranges::none_of(step_world.ground->planes, same)) body.motion = Motion::dynamic;
  if (body.motion == Motion::settling) {
    if (advance_clip(clip, body, kind, gravity, time, clip_settings) && settings_.sleeping) put_to_sleep(body);
    return;
  }
  tally = step_support_body(body, kind, step_world, time, support_settings);
  if (tally.touched_plane < 0) return update_quiet(slot, faces, time, tally);
  const HalfSpace& plane = step_world.ground->planes[std::size_t(tally.touched_plane)];
  if (!kind.clips.empty() && step_world.is_horizontal(plane)) {
    if (const auto joined = find_clip(body, kind, plane, gravity, clip_settings)) {
      clip = *joined;
      body.motion = Motion::settling;
      return;
    }
  }
  update_quiet(slot, faces, time, tally);
}

}  // namespace lodestone
