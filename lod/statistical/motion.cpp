// Stage 3: flight and ground contact of bodies that touch no other.
#include "lod/statistical/statistical_level_internal.h"

#include <algorithm>
#include <cmath>

#include "lod/statistical/support_model.h"

namespace lodestone {

void StatisticalLevel::Impl::move_support(StatisticalBody& body, int slot, const StaticGround& over, double dt, ContactTally& tally) {
  const BodyKind& kind = kind_of(body);
  const double gravity = settings.gravity.norm();
  static const ClipSettings clip_settings;
  // A clip plays on its own ground only: that of a static solid ends at an edge.
  const auto same = [&](const HalfSpace& plane) { return plane.normal == clips[slot].ground.normal && plane.offset == clips[slot].ground.offset; };
  if (body.motion == Motion::settling && std::ranges::none_of(over.planes, same)) body.motion = Motion::dynamic;
  if (body.motion == Motion::settling) {
    if (advance_clip(clips[slot], body, kind, gravity, dt, clip_settings) && settings.sleeping) put_to_sleep(body);
    return;
  }
  static const SupportSettings support_settings;
  StepWorld step_world = world();
  step_world.ground = &over;
  tally = step_support_body(body, kind, step_world, dt, support_settings);
  if (tally.touched_plane < 0) return update_quiet(body, dt, tally);
  const HalfSpace& plane = over.planes[std::size_t(tally.touched_plane)];
  if (!kind.clips.empty() && step_world.is_horizontal(plane)) {
    if (const auto clip = find_clip(body, kind, plane, gravity, clip_settings)) {
      clips[slot] = *clip;
      body.motion = Motion::settling;
      return;
    }
  }
  update_quiet(body, dt, tally);
}

// The planes, and the faces of static solids that the body lies over.
const StaticGround& StatisticalLevel::Impl::ground_below(std::int32_t slot) const {
  const std::span<const HalfSpace> faces = faces_below.of(slot);
  if (faces.empty()) return ground;
  thread_local StaticGround with_faces;
  with_faces.planes = ground.planes;
  with_faces.planes.insert(with_faces.planes.end(), faces.begin(), faces.end());
  return with_faces;
}

void StatisticalLevel::Impl::move_alone(std::size_t place, double dt, ContactTally& tally) {
  const std::int32_t slot = awake[place];
  move_support(bodies[slot], slot, ground_below(slot), dt, tally);
}

}  // namespace lodestone
