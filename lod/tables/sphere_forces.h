// What its callers push the bodies of `tables` with, as it acts through a step. They begin it with the
// velocity that it gives them in all.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lod/statistical/acting_forces.h"
#include "lod/tables/sphere_clips.h"
#include "lod/tables/sphere_scene.h"
#include "reference/state_archive.h"

namespace lodestone {

class SphereForces {
 public:
  explicit SphereForces(const SphereScene& scene) : scene_(scene) {}

  // For the next step.
  void push(int slot, const Vec3& force, const Vec3& torque) { pushes_.push_back({slot, force, torque}); }
  void forget(int slot);
  void rename(int from, int to);

  // In this one.
  void apply(double dt, SphereClips& clips, ContactTally& tally);
  const ActingForces& acting() const { return acting_; }
  /// m/s, by place awake: what they give; none where none acts. What presses together does not strike.
  std::span<const Eigen::Vector3f> by_place();
  /// Once more, times `share`.
  void give(double share);
  /// Of bodies that flew through the whole step: a force acted through it, not at its beginning.
  void take_back_excess();

  void archive(StateArchive& a) { a(pushes_); }
  std::size_t bytes() const { return pushes_.capacity() * sizeof pushes_[0]; }

 private:
  struct Push {
    std::int32_t slot;
    Vec3 force, torque;
  };

  const SphereScene& scene_;
  const StepConstants& constants_ = scene_.constants;
  const SphereStep& step_ = scene_.step;
  Spheres& spheres_ = scene_.spheres;

  std::vector<Push> pushes_;
  ActingForces acting_;
  std::vector<Eigen::Vector3f> by_place_;
};

}  // namespace lodestone
