// A shape's statistical signature (section 3.2 of Hsu and Keyser, Statistical Simulation of Rigid Bodies, 2009): what its collisions and
// settling look like under ODE, measured beforehand (measure.h), stored (signature_file.h) and looked up while simulating.
//
// Everything is dimensionless, so that one signature serves all sizes and densities of a shape: lengths over R (the greatest distance of a
// vertex from the centre of mass), speeds over s = √(v² + R²ω²), times over √(R/g).
//
// Symbols: n collision plane normal, V⁻ Ω⁻ velocities before the collision, e1 = n, e3 = n × V⁻ normalised (the working plane's normal),
// e2 = e3 × e1; θ = ∠(V⁻, −n), φ = ∠(V⁻, Ω⁻), α = atan(R‖Ω⁻‖ / ‖V⁻‖); V_particle = V⁻ − (1 + e)(V⁻·n) n.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "reference/geometry.h"
#include "reference/material.h"

namespace lodestone {

/// Collision height over α: the paper's radius of the colliding sphere (3.2.1, figure 3). Sampled evenly in α from 0 to π/2, so
/// closely at small ‖ω‖/‖v‖ and sparsely at large.
struct CollisionHeights {
  std::vector<float> mean;       ///< height of the centre of mass over the plane at contact, over R
  std::vector<float> deviation;
};

/// Six numbers in the frame (e1, e2, e3): (V_rigid − V_particle)/s, then RΩ⁺/s.
using Response = Eigen::Matrix<float, 6, 1>;

/// Means and deviations of the response over cells of (θ, φ, α) (3.2.2). Cell centres: θ = (i + ½)π/(2 n_theta), φ = (j + ½)π/n_phi,
/// α = (k + ½)π/(2 n_alpha); cell index (i n_phi + j) n_alpha + k.
struct ResponseTable {
  int n_theta = 0, n_phi = 0, n_alpha = 0;
  std::vector<Response> mean, deviation;
  std::vector<std::uint32_t> samples;  ///< trials behind each cell
  int cells() const { return n_theta * n_phi * n_alpha; }
};

/// A pose in which the body comes to rest on a horizontal plane (3.2.3).
struct RestPose {
  Vec3 normal = Vec3::UnitZ();  ///< the plane's normal in body axes: n_rest
  double height = 0.0;          ///< of the centre of mass over the plane, over R: h_rest
  double frequency = 0.0;       ///< fraction of settling trials that ended in it
};

/// One frame of a settling clip, 16 bits a number (encode_frame and decode_frame in settling_clips.h).
struct ClipFrame {
  std::array<std::int16_t, 3> position;          ///< x, y from the clip's start over its `extent`, z over kClipHeightRange; of 32767
  std::array<std::int16_t, 4> orientation;       ///< w, x, y, z; of 32767
  std::array<std::int16_t, 3> velocity;          ///< over kClipSpeedRange √(gR); of 32767
  std::array<std::int16_t, 3> angular_velocity;  ///< over kClipSpeedRange √(g/R); of 32767
};

/// ODE's own settling from low energy to rest on a horizontal plane, recorded (position over R).
struct SettlingClip {
  std::uint32_t first_frame = 0, frames = 0;  ///< run of Signature::clip_frames
  float extent = 1.0f;                        ///< greatest |x|, |y| in it, over R
};

/// A frame of a clip in contact with the plane, where a body may join it.
struct ClipEntry {
  std::uint32_t clip = 0, frame = 0;  ///< frame counted within the clip
};

/// When a single-collision trial stops.
enum class TrialEnd : std::uint8_t {
  first_impulse,  ///< the paper's
  leaves_plane,   ///< when no vertex moves into the plane any more
};

/// How a signature is measured; part of its identity.
struct SignatureSettings {
  ContactLaw law;
  TrialEnd trial_end = TrialEnd::leaves_plane;
  int n_theta = 7, n_phi = 10, n_alpha = 16;   ///< θ and φ as in the paper; α stands for its ‖V‖ and ‖Ω‖
  int trials_per_cell = 60;
  int height_samples = 16, height_trials = 2000;
  int settling_trials = 1000;
  int clips = 200;
  double rest_pose_frequency_min = 0.004;      ///< rarer rest poses are dropped (the paper: .05)
  std::uint64_t seed = 1;
  friend bool operator==(const SignatureSettings&, const SignatureSettings&) = default;
};

/// Pure data; immutable once made.
struct Signature {
  std::uint64_t shape_hash = 0;      ///< Shape::content_hash that it was measured for
  SignatureSettings settings;
  std::string shape_name;
  CollisionHeights collision_heights;
  ResponseTable bouncing;            ///< normal speed above ODE's bounce_vel
  ResponseTable non_bouncing;        ///< below it, where restitution is 0
  std::vector<RestPose> rest_poses;  ///< most frequent first
  int rest_poses_above_5_percent = 0;  ///< the paper's count
  std::vector<SettlingClip> clips;
  std::vector<ClipFrame> clip_frames;
  std::vector<ClipEntry> clip_entries;
  float clip_frame_interval = 0.0f;  ///< time between frames over √(R/g)
  std::uint64_t trials = 0;          ///< collision and settling trials simulated
  double measuring_seconds = 0.0;    ///< wall time
};

}  // namespace lodestone
