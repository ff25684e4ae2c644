// Stage 3: flight and ground contact of bodies that touch no other.
#include "lod/statistical/statistical_level_internal.h"

#include <algorithm>
#include <cmath>

#include "lod/statistical/support_model.h"

namespace lodestone {

void StatisticalLevel::Impl::move_support(StatisticalBody& body, int slot, double dt, ContactTally& tally) {
  const BodyKind& kind = kind_of(body);
  const double gravity = settings.gravity.norm();
  static const ClipSettings clip_settings;
  if (body.motion == Motion::settling) {
    const HalfSpace& plane = ground.planes[resting[slot].plane];
    if (advance_clip(clips[slot], body, kind, plane, gravity, dt, clip_settings)) {
      if (settings.sleeping) put_to_sleep(body);
    }
    return;
  }
  static const SupportSettings support_settings;
  tally = step_support_body(body, kind, world(), dt, support_settings);
  if (tally.touched_plane < 0) return update_quiet(body, dt, tally);
  const HalfSpace& plane = ground.planes[tally.touched_plane];
  if (!kind.clips.empty() && world().is_horizontal(plane)) {
    if (const auto clip = find_clip(body, kind, plane, gravity, clip_settings)) {
      clips[slot] = *clip;
      resting[slot].plane = tally.touched_plane;
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

void StatisticalLevel::Impl::move_alone(int slot, double dt, ContactTally& tally) {
  if (tables()) move_tables(bodies[slot], slot, dt, tally);
  else move_support(bodies[slot], slot, dt, tally);
}

}  // namespace lodestone
