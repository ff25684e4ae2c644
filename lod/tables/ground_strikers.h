// Who strikes the ground with others right behind it. Alone it would be moved after all contacts, and those
// that follow would learn of it a step later, one after the other: a column would sink into itself. So it is
// moved first, and in the rounds of contacts the ground holds it at the speed with which it leaves.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lod/tables/guest.h"
#include "lod/tables/near_ground.h"
#include "lod/tables/sphere_scene.h"

namespace lodestone {

class GroundStrikers {
 public:
  GroundStrikers(const SphereScene& scene, const NearGround& ground) : scene_(scene), near_ground_(ground) {}

  void clear() { strikers_.clear(); }
  /// Places of those that are to be moved first, and then to be added. `guests` are moved later, among hulls.
  std::span<const std::uint32_t> find(std::span<const Guest> guests);
  /// Its contacts see it as it is now.
  void add(std::int64_t place);
  /// The ground's part of a round.
  void hold();
  /// Once all have moved: what its contacts gave each beside that, after it was moved.
  void finish(ContactTally& tally);

  std::size_t bytes() const {
    return strikers_.capacity() * sizeof strikers_[0] + striking_.capacity() * sizeof striking_[0] +
           followed_.capacity() * sizeof followed_[0];
  }

 private:
  /// One that has been moved.
  struct Striker {
    std::int64_t place = 0;
    Vec3 normal = Vec3::Zero();  // of the ground
    double leaves = 0.0;         // m/s, along it
    double given = 0.0;          // m/s: what the ground gives it against those behind it
  };

  bool strikes(std::int64_t place) const;
  void find_followed();

  const SphereScene& scene_;
  const NearGround& near_ground_;
  const StepConstants& constants_ = scene_.constants;
  const SphereContacts& contacts_ = scene_.contacts;
  Spheres& spheres_ = scene_.spheres;
  SphereStep& step_ = scene_.step;

  std::vector<Striker> strikers_;        // in this step
  std::vector<std::uint32_t> striking_;  // places: who strikes the ground and touches others
  std::vector<std::uint8_t> followed_;   // of each place awake, where any does
};

}  // namespace lodestone
