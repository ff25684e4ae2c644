// A recorded run as a file that `lodestone view` plays: poses and statuses of every body and frame, what to
// draw, and what the steps came to.
#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "scenes/trajectory.h"

namespace lodestone {

inline constexpr int kPlaybackVersion = 1;

/// What a viewer is told of a run besides its bodies.
struct PlaybackTitle {
  std::string label;            ///< "bunnies: level full"
  int from_step = 0;            ///< where it begins: a fork's begins later
  std::vector<double> step_ms;  ///< processor time, of each step from there on
  double dt_s = 1.0 / 60.0;
};

/// A playback file, read: its header, and its blobs as they are in the file (deflated, little-endian), one
/// after the other.
///
/// The header's `blobs` has {`offset`, `bytes`, `raw_bytes`} of:
/// - `poses`: for each frame 20 planes of one byte a body: the four bytes of x, y and z in units of `unit_m`,
/// then the two of the quaternion's x, y, z, w times 32767. Each number is the difference
///   to what the two frames before let expect (2 p' − p''; in the second frame p'), modulo 2³² and 2¹⁶.
/// - `status`: for each frame a byte a body, rung + 4 · asleep + 8 · rule, xor that of the frame before.
/// - `spheres`: for each frame a byte a body, the collision sphere's radius over the bounding sphere's × 255,
/// 0 for none, xor that of the frame before.
/// - `meshes`: floats x, y, z of all vertices, then the corners of all faces, 32 bits each.
struct Playback {
  nlohmann::ordered_json header;
  std::vector<std::byte> blobs;
};

/// Writes `file` (through a temporary file beside it). Meshes are simplified so far that all bodies together
/// have some three million faces at most. Throws InputError where it cannot be written.
void save_playback(const std::filesystem::path& file, const Trajectory& trajectory, const Scene& scene,
                   const PlaybackTitle& title);

/// Throws InputError for what is no playback file of this version, or damaged.
Playback load_playback(const std::filesystem::path& file);

}  // namespace lodestone
