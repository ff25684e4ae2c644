// Bodies that touch no other move over planes on their hulls, as those of `support` do, with fewer and
// coarser contact steps, and so do others in a step in which they strike the ground. Departs from the paper's
// sphere of the mean height (3.3.1), which is blind to the orientation: its first impulse is off by 36 to 47
// %, and single drops by three times as much.
#pragma once

#include <cstdint>
#include <vector>

#include "lod/support/hull_motion.h"
#include "lod/tables/near_ground.h"
#include "lod/tables/sphere_clips.h"
#include "lod/tables/sphere_scene.h"

namespace lodestone {

class HullsOnGround {
 public:
  HullsOnGround(const SphereScene& scene, const NearGround& ground, SphereClips& clips)
      : scene_(scene), near_ground_(ground), clips_(clips) {}

  /// Of spheres at places [begin, end): those that touched no other for a while stand on their hulls, as
  /// guests do at edges; the others are spheres.
  void choose(std::int64_t begin, std::int64_t end);
  /// It has come to rest, does not sleep, and its ground is what it was.
  bool lies_at_clips_end(std::int64_t place) const;
  /// Of one that moves on as a sphere.
  void become_sphere(std::int64_t place, StatisticalBody& body);
  /// The sphere that others would meet is as high as the body stands. `rides`: on ground that moves; a clip
  /// that it begins goes to `joined`.
  ContactTally move(std::int64_t place, StatisticalBody& body, const StepWorld& around, bool rides,
                    std::vector<SphereClips::Playing>& joined);
  /// Of one that is among others, or was a little before, and strikes the ground. (Drawn from the tables, the
  /// impulse would set spinning what lands flat.)
  ContactTally strike(std::int64_t place, StatisticalBody& body, StepWorld around);
  /// Of a guest that was moved on its hull.
  void take_from_edge(std::int64_t place, const StatisticalBody& moved);
  /// Whether it may come to rest as it stands.
  bool stands(std::int64_t place) const;

 private:
  const HullMotionSettings& motion_settings(const StatisticalBody& body, const BodyKind& kind,
                                            const StepWorld& around) const;
  bool stands_when_alone(std::int64_t place) const;
  bool is_at_edge(std::int64_t place) const;
  bool overlaps_ground(const StatisticalBody& body, const BodyKind& kind) const;
  float height_over_ground(std::int64_t place, const StatisticalBody& body) const;

  const SphereScene& scene_;
  const NearGround& near_ground_;
  SphereClips& clips_;
  const StatisticalSettings& settings_ = scene_.settings;
  const Ground& ground_ = scene_.ground;
  const StepConstants& constants_ = scene_.constants;
  Spheres& spheres_ = scene_.spheres;
  SphereStep& step_ = scene_.step;
};

}  // namespace lodestone
