// A body meets the plane that carries it as ground; in a corner it touches more, and is held by each.
#pragma once

#include <cstdint>
#include <vector>

#include "lod/tables/near_ground.h"
#include "lod/tables/sphere_scene.h"

namespace lodestone {

class FurtherPlanes {
 public:
  FurtherPlanes(const SphereScene& scene, const NearGround& ground) : scene_(scene), ground_(ground) {}

  void clear() { touches_.clear(); }
  /// Adds those that are touched to the contacts: after all others.
  void find();
  bool touches(std::int64_t place) const;
  std::size_t bytes() const { return touches_.capacity() * sizeof touches_[0]; }

 private:
  void note_paired();
  void look(std::int64_t place, std::int32_t number);

  const SphereScene& scene_;
  const NearGround& ground_;
  std::vector<PlaneTouch> touches_;  // of this step, by place
  std::vector<char> paired_;         // of each place: whether it has contacts with others
};

}  // namespace lodestone
