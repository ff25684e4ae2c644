// The geoms of a caller's space that no dynamic body carries, as ground for the statistical rungs: followed
// from step to step as they come, move and go.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "lod/ground/ground.h"
#include "reference/ode/space_mirror.h"

namespace lodestone {

class CallersGround {
 public:
  /// `ground` must outlive it.
  explicit CallersGround(Ground& ground) : ground_(ground) {}

  /// What wakes, where boxes of the world and planes have changed.
  struct Wakes {
    std::function<void(const Eigen::AlignedBox3d&)> disturbed;  ///< something came or moved there
    std::function<void(const Eigen::AlignedBox3d&)> gone;       ///< what was there is elsewhere, or nowhere
    std::function<void(const HalfSpace&)> came;
  };
  /// Brings the ground to what the mirror saw in its last refresh, for a step of `dt` s. What has moved did
  /// so in `since` s; 0: in a later part of a step, in which what was put on before goes on. `up` (unit,
  /// world) is against gravity: what is known by rays alone is met from there.
  void follow(const SpaceMirror& mirror, double dt, double since, const Vec3& up, const Wakes& wakes);

  /// Which of the geoms had a velocity in the last step; after the mirror. Where it reads, the ground has
  /// followed them twice since they were put where they were when that was written.
  void archive(StateArchive& a, const SpaceMirror& mirror);

  /// The geom that a part or plane is; null where it is none of the caller's.
  dxGeom* geom_of(GroundId id) const;

 private:
  void add(const MirroredGeom& geom, std::uint32_t slot, double dt);
  void remove(std::uint32_t slot);
  /// `moved_in`: s, in which it was put elsewhere; 0: it was not.
  GroundPose pose_of(const MirroredGeom& geom, double dt, double moved_in) const;

  Ground& ground_;
  std::vector<GroundId> ids_;           // by the mirror's slots; null: not ground
  std::vector<dxGeom*> geoms_;          // by the index of their ids
  std::vector<std::uint32_t> carried_;  // slots of those with a kinematic body
  std::vector<std::uint32_t> moving_;   // slots of those that had a velocity in the last step
  std::vector<std::uint32_t> probed_;   // slots of those of other classes than ODE's own
  std::shared_ptr<GeomProbe> probe_ = std::make_shared<GeomProbe>();
};

}  // namespace lodestone
