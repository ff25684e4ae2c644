// Plays a settling clip for a body: how `support` brings a body to rest on a horizontal plane.
#pragma once

#include "lod/ground/ground.h"
#include "lod/statistical/statistical_body.h"
#include "signature/settling_clips.h"

namespace lodestone {

/// A clip under way. The residual is what the body's pose differed from the clip's by when it joined; it
/// fades away.
struct ClipPlayback {
  std::uint32_t clip = 0;
  double frame = 0.0;                     ///< within the clip
  HalfSpace ground;                       ///< what it settles on
  Quat yaw = Quat::Identity();            ///< clip frame to world
  Vec3 origin = Vec3::Zero();             ///< m, world point of the clip's x = y = 0 on the plane
  Vec3 residual_position = Vec3::Zero();  ///< m
  Vec3 residual_rotation = Vec3::Zero();  ///< rad, rotation vector, world axes
  double residual_left = 0.0;             ///< 1 at the start, 0 when faded
};

struct ClipSettings {
  /// J/kg over g R: kinetic energy below which a body at a contact may join a clip.
  double energy_limit = 0.15;
  float energy_slack = 0.002f;  ///< over m g R: what a clip's energy may exceed the body's by
  /// How far the nearest entry may be, in ClipIndex::find_nearest's measure, over the kinetic energy of its
  /// rocking over m g R …
  float distance_over_energy = 0.5f;
  float least_distance = 0.002f,
        greatest_distance = 0.1f;  ///< … within these: what differs by more than it moves is another motion
  double fade_time = 0.15;         ///< s at R = .2 m and 9.81 m/s², scaled with √(R/g)
};

/// The clip that `body`, touching `ground` (horizontal), may join; none where it moves too fast or nothing
/// near was recorded.
std::optional<ClipPlayback> find_clip(const StatisticalBody& body, const BodyKind& kind,
                                      const HalfSpace& ground, double gravity, const ClipSettings& settings);

/// Moves `body` along its clip by `time` seconds; velocities are those of the motion shown. True when the
/// clip is over: the body rests.
bool advance_clip(ClipPlayback& playback, StatisticalBody& body, const BodyKind& kind, double gravity,
                  double time, const ClipSettings& settings);

}  // namespace lodestone
