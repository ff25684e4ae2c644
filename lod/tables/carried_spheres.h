// Who is moved on together with those that it touches: carried by what nothing stops, as CarriedBodies are,
// drawn by a force, or falling. None of them comes to rest.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lod/tables/near_ground.h"
#include "lod/tables/sphere_forces.h"
#include "lod/tables/sphere_scene.h"
#include "reference/disjoint_sets.h"

namespace lodestone {

class CarriedSpheres {
 public:
  CarriedSpheres(const SphereScene& scene, const NearGround& ground, const SphereForces& forces)
      : scene_(scene), near_ground_(ground), forces_(forces) {}

  void begin_step() { guests_.clear(); }
  /// A guest that is carried.
  void add_guest(std::int64_t place) { guests_.push_back(place); }
  /// What lies near-still on others is brought to a stop in the world, but not with what carries it, and not
  /// where a force draws it or them on. Where the ground's friction does not hold that force, nobody is to
  /// sleep. Before the bodies move.
  void let_go();
  /// What falls with all that it touches does not lie on it, however long they touch. After the bodies have
  /// moved, `elapsed` s since the first step.
  void note_who_falls(double elapsed);
  /// For rides(): after note_who_falls().
  void find_riders();
  /// Whether what nothing stops moves it, directly or through others.
  bool rides(std::int64_t place) {
    return any_rides_ && riders_.root_of(std::int32_t(place)) == riders_.root_of(nothing_stops_);
  }
  /// Whether a force draws it, or those with it, that the ground does not hold.
  bool is_drawn_off(std::int64_t place) const {
    return std::size_t(place) < let_go_.size() && let_go_[std::size_t(place)] == LetGo::off;
  }
  /// m/s, in this step, out of overlaps too.
  double moving_speed(std::int64_t place) const;

 private:
  enum class LetGo : std::uint8_t { no, on, off };

  void join_touching();
  void join_carried();
  bool hangs(std::int64_t place) const;
  double ground_friction(std::int64_t place) const;

  const SphereScene& scene_;
  const NearGround& near_ground_;
  const SphereForces& forces_;
  const StatisticalSettings& settings_ = scene_.settings;
  const StepConstants& constants_ = scene_.constants;
  const SphereContacts& contacts_ = scene_.contacts;
  const SphereStep& step_ = scene_.step;
  Spheres& spheres_ = scene_.spheres;

  std::vector<std::int64_t> guests_;             // places, in this step
  std::vector<std::int32_t> drawn_, drawn_off_;  // places awake
  std::vector<LetGo> let_go_;                    // of each place awake
  DisjointSets riders_;                          // of the places awake, and what nothing stops
  bool any_rides_ = false;
  std::int32_t nothing_stops_ = 0;  // its number there
};

}  // namespace lodestone
