// A run recorded frame by frame, and saved as a binary glTF file (.glb) that any viewer plays.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "scenes/scene.h"

namespace lodestone {

/// Poses and rungs of a fixed number of bodies over time; 21 bytes a body and frame. Frames are kept as they come, body after body.
class Trajectory {
 public:
  using Position = std::array<float, 3>;         ///< m
  using Orientation = std::array<std::int16_t, 4>;  ///< x, y, z, w of 32767

  explicit Trajectory(int bodies) : bodies_(bodies) {}
  /// One state and rung for each body. A frame that is not later than the last by a float's precision is left out.
  void add_frame(double time_s, std::span<const RigidState> states, std::span<const Rung> rungs);

  int bodies() const { return bodies_; }
  int frames() const { return int(times_.size()); }
  std::span<const float> times_s() const { return times_; }
  const Position& position(int frame, int body) const { return positions_[index(frame, body)]; }
  const Orientation& orientation(int frame, int body) const { return orientations_[index(frame, body)]; }
  Rung rung(int frame, int body) const { return rungs_[index(frame, body)]; }
  /// Frames until the body moves no more: those that have to be saved.
  int moving_frames(int body) const;

 private:
  std::size_t index(int frame, int body) const { return std::size_t(frame) * std::size_t(bodies_) + std::size_t(body); }
  int bodies_ = 0;
  std::vector<float> times_;
  std::vector<Position> positions_;
  std::vector<Orientation> orientations_;
  std::vector<Rung> rungs_;
};

/// A .glb holds 4 GB: the most frames that may be recorded of so many bodies.
int max_trajectory_frames(int bodies);

/// Writes `file` (through a temporary file beside it): one mesh for each shape and rung, one node for each body, orange while full, blue
/// at `support` and dark green at `tables`, the ground, and the first viewpoint as camera. Bodies are those of `scene`, in its order. Throws InputError where the
/// file cannot be written.
void save_trajectory(const std::filesystem::path& file, const Trajectory& trajectory, const Scene& scene);

}  // namespace lodestone
