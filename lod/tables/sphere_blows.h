// Blows that go on through balls which touch. (What is a sphere for lack of a hull takes them as a whole:
// passed on, they made poured boxes overlap by half of their size and rest a fifth later.)
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "lod/contact/impact_waves.h"
#include "lod/tables/near_ground.h"
#include "lod/tables/sphere_scene.h"

namespace lodestone {

class SphereBlows {
 public:
  SphereBlows(const SphereScene& scene, const NearGround& ground) : scene_(scene), near_ground_(ground) {}

  /// Gives the bodies what blows leave them; what the contacts are answered with next knows of these no more.
  void pass_on();
  /// In this step: contacts through which a blow went on, with what it gave.
  std::span<const SphereContact> passed() const { return passed_; }

 private:
  bool find();
  Vec3 given_by_ground(std::uint32_t place) const;
  void gather_open_contacts();
  void give_to_bodies();
  void note_passed();

  const SphereScene& scene_;
  const NearGround& near_ground_;
  const MaterialTable& materials_ = scene_.materials;
  const SphereKinds& kinds_ = scene_.kinds;
  const StepConstants& constants_ = scene_.constants;
  const Spheres& spheres_ = scene_.spheres;
  SphereContacts& contacts_ = scene_.contacts;
  SphereStep& step_ = scene_.step;

  ImpactWaves waves_;
  std::vector<std::uint8_t> struck_;    // of each place awake
  std::vector<std::int32_t> numbered_;  // of each place awake: its number in bodies_; −1: none
  std::vector<std::int64_t> places_;    // of each number; −1: ground that moves
  std::vector<SolverBody> bodies_,      // what may be struck
      bodies_before_;                   // the blows
  std::vector<CrowdManifold> manifolds_;
  std::vector<CrowdPoint> points_;
  std::vector<std::pair<ContactArrays*, std::size_t>> found_;  // where each manifold's contact is
  std::vector<SphereContact> passed_;
};

}  // namespace lodestone
