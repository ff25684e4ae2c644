// A shape's statistical signature (section 3.2 of Hsu and Keyser, Statistical Simulation of Rigid Bodies,
// 2009): how it collides and settles under ODE. It is measured beforehand (measure.h), stored
// (signature_file.h) and looked up while simulating.
//
// Everything is dimensionless, so that one signature serves all sizes and densities of a shape: lengths are
// divided by R (the greatest distance of a vertex from the centre of mass), speeds by s = √(v² + R²ω²), times
// by √(R/g).
//
// The symbols of collisions are listed in response.h. Numbers in parentheses are sections of the paper.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "reference/geometry.h"
#include "reference/hull/hull.h"
#include "reference/material.h"
#include "signature/collision_heights.h"
#include "signature/response.h"
#include "signature/rung_errors.h"

namespace lodestone {

/// A pose in which the body comes to rest on a horizontal plane (3.2.3).
struct RestPose {
  Vec3 normal = Vec3::UnitZ();  ///< the plane's normal in body axes: n_rest
  double height = 0.0;          ///< of the centre of mass over the plane, over R: h_rest
  double frequency = 0.0;       ///< fraction of settling trials that ended in it
  double basin = 0.0;  ///< fraction of orientations from which the body, set down without speed, tips into it
};

/// One frame of a settling clip, with 16 bits for each number (encode_frame and decode_frame in
/// settling_clips.h).
struct ClipFrame {
  std::array<std::int16_t, 3>
      position;  ///< x, y from the clip's start over its `extent`, z over kClipHeightRange; of 32767
  std::array<std::int16_t, 4> orientation;       ///< w, x, y, z; of 32767
  std::array<std::int16_t, 3> velocity;          ///< over kClipSpeedRange √(gR); of 32767
  std::array<std::int16_t, 3> angular_velocity;  ///< over kClipSpeedRange √(g/R); of 32767
};

/// A recording of ODE's own settling, from low energy to rest on a horizontal plane.
struct SettlingClip {
  std::uint32_t first_frame = 0, frames = 0;  ///< its frames in Signature::clip_frames: the first, how many
  float extent = 1.0f;                        ///< greatest |x| or |y| in it, over R
};

/// A frame of a clip in contact with the plane: there a body may join the clip.
struct ClipEntry {
  std::uint32_t clip = 0, frame = 0;  ///< frame counted within the clip
};

/// When the trial of a single collision ends.
enum class TrialEnd : std::uint8_t {
  first_impulse,  ///< after the first impulse, as in the paper
  leaves_plane,   ///< when the body flies off without another impact
};

/// How a signature is measured; part of its identity. Ranges, outside which measuring throws InputError:
/// numbers of cells 1 … 1000, height_samples 2 … 1e7, held_out_conditions and clips 0 … 1e7, other counts 1 …
/// 1e7, table_error and rest_pose_frequency_min 0 … 1.
struct SignatureSettings {
  ContactLaw law;
  TrialEnd trial_end = TrialEnd::leaves_plane;
  bool paper_grid = false;  ///< responses over the paper's θ 7 × φ 10 × ‖V‖ 26 × ‖Ω‖ 16, 30 trials each,
                            ///< instead of over (θ, φ, α, ψ)
  int n_theta = 7, n_phi = 10, n_alpha = 16;  ///< cells: θ, φ as in the paper, α for its ‖V‖ and ‖Ω‖
  int n_psi = 1;                              ///< cells; 1: every ψ in one, as in the paper
  ResponseDraw draw = ResponseDraw::independent;  ///< what is kept for draws beyond the independent ones
  int trials_per_cell = 60;
  double table_error = 0.0;  ///< above 0: cells get trials until no mean has a greater standard error, over s
  int most_trials_per_cell = 4000;  ///< then no cell gets more
  int held_out_conditions =
      500;  ///< random ones, with 16 trials each kept out of the tables, that certify each table
  int height_samples = 16, height_trials = 2000;
  int settling_trials = 1000;
  int clips = 100;
  double rest_pose_frequency_min = 0.004;  ///< rarer rest poses are dropped (the paper: .05)
  std::uint64_t seed = 1;
  friend bool operator==(const SignatureSettings&, const SignatureSettings&) = default;
};

/// How good a table of responses is.
struct TableCertificate {
  std::uint64_t trials = 0, missed = 0;              ///< in the table; `missed`: never touched the plane
  std::uint32_t fewest_trials = 0, most_trials = 0;  ///< of a cell
  double impulses = 0.0;                             ///< in a trial, mean
  double into_plane_first = 0.0,
         into_plane =
             0.0;  ///< fraction of bodies moving into the plane after the first impulse, and at the end
  double energy_ratio_first = 0.0,
         energy_ratio = 0.0;  ///< kinetic, after over before: mean, after the first impulse, and at the end
  /// Whether these are known: rows of measurements say only how a body left.
  bool knows_first_impulse() const { return energy_ratio > 0.0; }
  double mean_over_deviation = 0.0;  ///< |μ_V|/σ_V over the table (the paper: near 0)
  double standard_error = 0.0,
         greatest_standard_error =
             0.0;              ///< of the six numbers of cells' means, over s: root mean square, greatest
  std::uint64_t held_out = 0;  ///< trials that are not in the table
  double held_out_ks = 0.0;  ///< Kolmogorov–Smirnov distance between draws and held-out trials: normal speed,
                             ///< speed or spin after, the greatest
  double held_out_error = 0.0;  ///< root mean square error of a number of the mean looked up, over s
  double uniform_trials =
      0.0;  ///< what the same greatest standard error would take with the same number of trials in each cell
};

/// A shape's signature under a contact law. Pure data, immutable once made.
struct Signature {
  std::uint64_t shape_hash = 0;  ///< Shape::content_hash of the shape that it was measured for
  SignatureSettings settings;
  std::string shape_name;
  std::uint32_t mesh_vertices = 0, mesh_faces = 0;  ///< counts of the shape that it was measured for
  std::string versions;  ///< of the file format, the measuring code and ODE that made it
  CollisionHeights collision_heights;
  ResponseTable bouncing;      ///< approach above ODE's bounce_vel; empty where measured on the paper's grid
  ResponseTable non_bouncing;  ///< below it, where restitution is 0
  SpeedTable by_speed;         ///< the paper's grid; else empty
  TableCertificate bouncing_certificate, non_bouncing_certificate, by_speed_certificate;
  std::vector<RestPose> rest_poses;    ///< most frequent first
  int rest_poses_above_5_percent = 0;  ///< the paper's count
  SupportMapError support_map_error;   ///< of the shape's support map without the climb, over R
  std::vector<SettlingClip> clips;
  std::vector<ClipFrame> clip_frames;
  std::vector<ClipEntry> clip_entries;
  float clip_frame_interval = 0.0f;  ///< time between frames over √(R/g)
  std::uint64_t trials = 0;          ///< collision and settling trials simulated
  RungErrors rung_errors;  ///< not in the file but beside it, since it is measured with what stands above
  double measuring_seconds =
      0.0;  ///< wall time; not in the file, whose bytes are the same however long it took
};

}  // namespace lodestone
