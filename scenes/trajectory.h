// A run recorded frame by frame, and saved as a binary glTF file (.glb) that any viewer plays.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "lod/why.h"
#include "scenes/scene.h"

namespace lodestone {

/// How a body is simulated at a moment.
struct BodyStatus {
  Rung rung = Rung::support;
  bool asleep = false;
  Rule rule = Rule::forced;         ///< that decided its rung
  float collision_radius_m = 0.0f;  ///< of its sphere at `tables`; 0 on other rungs
};

/// Poses and statuses of a fixed number of bodies over time; 28 bytes a body and frame. Frames are kept as
/// they come, body after body.
class Trajectory {
 public:
  using Position = std::array<float, 3>;            ///< m
  using Orientation = std::array<std::int16_t, 4>;  ///< x, y, z, w of 32767

  explicit Trajectory(int bodies) : bodies_(bodies) {}
  /// One state and status for each body. A frame that is not later than the last by a float's precision is
  /// left out.
  void add_frame(double time_s, std::span<const RigidState> states, std::span<const BodyStatus> statuses);
  /// Of the first frame anew, one for each body: before a first step nobody has a rung yet.
  void set_first_statuses(std::span<const BodyStatus> statuses);

  int bodies() const { return bodies_; }
  int frames() const { return int(times_.size()); }
  std::span<const float> times_s() const { return times_; }
  const Position& position(int frame, int body) const { return positions_[index(frame, body)]; }
  const Orientation& orientation(int frame, int body) const { return orientations_[index(frame, body)]; }
  const BodyStatus& status(int frame, int body) const { return statuses_[index(frame, body)]; }
  /// Frames until the body moves no more: those that have to be saved.
  int moving_frames(int body) const;

 private:
  std::size_t index(int frame, int body) const {
    return std::size_t(frame) * std::size_t(bodies_) + std::size_t(body);
  }
  int bodies_ = 0;
  std::vector<float> times_;
  std::vector<Position> positions_;
  std::vector<Orientation> orientations_;
  std::vector<BodyStatus> statuses_;
};

/// A .glb holds 4 GB: the most frames that may be recorded of so many bodies.
int max_trajectory_frames(int bodies);

/// Writes `file` (through a temporary file beside it): one mesh for each shape and rung, awake and asleep,
/// one node for each body, orange while full, blue at `support` and dark green at `tables`, darker asleep,
/// the ground, and a camera: the first viewpoint, or where there is none one that has all bodies in its
/// picture. Bodies are those of `scene`, in its order. Throws InputError where the file cannot be written.
void save_trajectory(const std::filesystem::path& file, const Trajectory& trajectory, const Scene& scene);

}  // namespace lodestone
