// Who is struck within a step may come to what was out of its reach when the ground and others were looked
// for, and would be behind it before anybody looks again. It stops there, and strikes it in the next step.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "lod/broad_phase/still_grid.h"
#include "lod/tables/near_ground.h"
#include "lod/tables/sphere_scene.h"

namespace lodestone {

class DrivenSpheres {
 public:
  /// `still`: those asleep, by slot.
  DrivenSpheres(const SphereScene& scene, const NearGround& ground, const StillGrid& still)
      : scene_(scene), near_ground_(ground), still_(still) {}

  /// A guest that hulls have driven: where it was, and its velocity, m/s.
  void add_guest(std::int64_t place, const Vec3& from, const Vec3& velocity) {
    guests_.push_back({place, from, velocity});
  }
  /// The bodies are about to move, in so many blocks.
  void begin_blocks(std::size_t blocks);
  /// Of the spheres of a block, at places [begin, end): whom contacts drove.
  void note(std::size_t block, std::int64_t begin, std::int64_t end);
  /// After all have moved.
  void stop_before_unseen();

 private:
  /// One that its contacts made faster, or drove off a long way; where it was, and its velocity.
  struct Driven {
    std::int64_t place = 0;
    Vec3 from = Vec3::Zero();      // m
    Vec3 velocity = Vec3::Zero();  // m/s
  };

  bool is_driven(std::int64_t place, const Vec3& before, const Vec3& velocity) const;
  void stop_before_unseen(const Driven& driven);
  double find_way_to_ground(const Driven& driven, const Vec3& way) const;
  double find_way_to_others(const Driven& driven, const Vec3& way, bool to_all);
  void sort_by_x();
  void find_awake_near(const Vec3& center, double reach, std::vector<std::int64_t>& found) const;
  BallWay way_of(const Driven& driven) const {
    return scene_.way(driven.place, driven.from, driven.velocity);
  }
  bool is_beyond(const Driven& driven, const Vec3& would_be, double reach) const;
  bool leaves_its_reach(const Driven& driven) const;
  bool leaves_its_way(const Driven& driven) const;
  double farthest_reach(std::int64_t place) const;
  double find_way_to(const Driven& driven, const Vec3& way, std::int64_t other);
  Driven find_start_of(std::int64_t place) const;

  const SphereScene& scene_;
  const NearGround& near_ground_;
  const StillGrid& still_;
  const StatisticalSettings& settings_ = scene_.settings;
  const Ground& ground_ = scene_.ground;
  const SphereKinds& kinds_ = scene_.kinds;
  const StepConstants& constants_ = scene_.constants;
  const SphereStep& step_ = scene_.step;
  Spheres& spheres_ = scene_.spheres;

  std::size_t blocks_ = 0;                             // in this step
  std::vector<std::vector<Driven>> driven_;            // by block
  std::vector<Driven> guests_;                         // in this step
  std::vector<std::int64_t> in_the_way_;               // places
  std::vector<std::pair<double, std::int64_t>> by_x_;  // m, and place: those awake, in the order of x
};

}  // namespace lodestone
