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

void StatisticalLevel::Impl::move_tables(StatisticalBody& body, int slot, double dt, ContactTally& tally) {
  const BodyKind& kind = kind_of(body);
  static const TablesSettings defaults;
  TablesSettings tables_settings = defaults;
  tables_settings.options = settings.tables;
  if (body.motion == Motion::settling) {
    const double rest = kind.signature->rest_poses[resting[slot].pose].height * kind.shape->radius;
    const double blend = defaults.blend_time * std::sqrt(kind.shape->radius / std::max(1e-9, settings.gravity.norm()));
    body.sphere_radius += float((rest - body.sphere_radius) * std::min(1.0, 2.0 * dt / blend));
  } else if (steps % std::max(1, settings.tables.radius_update_interval) == 0) {
    body.sphere_radius = float(find_sphere_radius(body, kind, settings.tables, settings.seed));
  }
  tally = step_tables_body(body, resting[slot], kind, world(), dt, tables_settings);
  update_quiet(body, dt, tally);
}

// The planes, and the faces of static solids that the body lies over.
const StaticGround& StatisticalLevel::Impl::ground_below(std::size_t place) const {
  if (faces_of.empty() || faces_of[place].first == faces_of[place].second) return ground;
  thread_local StaticGround with_faces;
  with_faces.planes = ground.planes;
  with_faces.planes.insert(with_faces.planes.end(), faces_below.begin() + faces_of[place].first, faces_below.begin() + faces_of[place].second);
  return with_faces;
}

void StatisticalLevel::Impl::move_alone(std::size_t place, double dt, ContactTally& tally) {
  const std::int32_t slot = awake[place];
  if (tables()) move_tables(bodies[slot], slot, dt, tally);
  else move_support(bodies[slot], slot, ground_below(place), dt, tally);
}

}  // namespace lodestone
