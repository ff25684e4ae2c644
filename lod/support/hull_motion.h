// How a body moves on its hull that touches no other: flight and impacts over the ground's planes, or a
// settling clip.
#pragma once

#include "lod/support/clip_player.h"
#include "lod/support/support_model.h"

namespace lodestone {

struct HullMotionSettings {
  SupportSettings support = {};
  ClipSettings clips = {};
};

struct HullMotion {
  ContactTally tally = {};
  bool plays_clip = false, clip_over = false;  ///< over: the body rests
};

/// Moves `body` by `time` seconds: along `clip` while it is Motion::settling, else by step_support_body,
/// after which it may join a clip if it `may_settle`. The clips were recorded under `clip_gravity` (m/s²,
/// world), which need not be the gravity that the body feels.
HullMotion move_on_hull(StatisticalBody& body, ClipPlayback& clip, const BodyKind& kind,
                        const StepWorld& world, const Vec3& clip_gravity, double time, bool may_settle,
                        const HullMotionSettings& settings, const Quat* turned = nullptr);

/// Whether it stands on three vertices at least: on an edge a body may balance for a while, but not for good.
bool stands_firmly(const StatisticalBody& body, const Shape& shape, std::span<const HalfSpace> planes);

}  // namespace lodestone
