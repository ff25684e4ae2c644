// Friction of the ground under bodies that lie on a face among others. Their contacts with these are answered
// before it, and would else find them in motion in each step by what the ground has yet to stop: so they
// begin with what it gave in the last step.
#pragma once

#include <cstdint>
#include <vector>

#include "lod/tables/near_ground.h"
#include "lod/tables/sphere_scene.h"
#include "reference/state_archive.h"

namespace lodestone {

class GroundRubbing {
 public:
  GroundRubbing(const SphereScene& scene, const NearGround& ground) : scene_(scene), ground_(ground) {}

  /// What it gave in the last step they have at the beginning of this one.
  void give();
  /// From whom the ground is about to rub for the whole of the step.
  void take_back();
  /// The last round of the ground is to come, of so many blocks of bodies; none where there is no ground.
  void begin_blocks(std::size_t blocks);
  // Around that round, of a block: their velocities before it, and what friction was of the change.
  void begin_round(std::size_t block, std::int64_t begin, std::int64_t end);
  void end_round(std::size_t block);
  /// After all blocks.
  void remember();

  void archive(StateArchive& a) { a(known_); }
  std::size_t bytes() const { return known_.capacity() * sizeof known_[0]; }

 private:
  struct Friction {
    std::uint32_t slot = 0, owner = 0;
    lane::F3 force;  // m/s², over the mass
  };
  struct Given {
    std::int64_t place = 0;
    lane::F3 velocity;  // m/s
  };

  bool rubs(std::int64_t place) const;

  const SphereScene& scene_;
  const NearGround& ground_;
  const Spheres& spheres_ = scene_.spheres;
  const StepConstants& constants_ = scene_.constants;
  SphereStep& step_ = scene_.step;

  std::vector<Friction> known_;               // of the last step, by slot
  std::vector<Given> given_;                  // of that, in this step
  std::vector<std::vector<Friction>> found_;  // in this step, by block
};

}  // namespace lodestone
