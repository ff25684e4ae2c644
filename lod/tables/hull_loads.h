// What hulls press onto bodies of `tables` that touch their own rung, too. Contacts with hulls are answered
// after those of spheres: what hulls pressed with in the last step these are to bear now, else what lies on a
// heap sinks into it at the speed that gravity gives it in a step.
#pragma once

#include <cstdint>
#include <vector>

#include "lod/tables/sphere_scene.h"
#include "reference/state_archive.h"

namespace lodestone {

class HullLoads {
 public:
  explicit HullLoads(const SphereScene& scene) : scene_(scene) {}

  /// After contacts have begun.
  void press();
  /// From whom no hull has moved after all, so that momentum is kept. What goes up or down stays: the ground
  /// bore it, and who bore it last must not be flung.
  void take_back();
  /// m/s²: what of the last step's was there in the step before, too; null for whom no hull pressed.
  const Vec3* steady_on(std::int64_t place) const;
  /// m/s²: how its like bore a sleeper in its last step awake; null for whom no hull pressed in it.
  const Vec3* borne_of_sleeper(std::int64_t place) const;
  /// Of a guest that hulls have moved from `before`. Takes from it what would fling it.
  void keep(std::int64_t place, const StatisticalBody& before, StatisticalBody& after);
  /// Of one that was woken in the midst of the step: what pressed it when it fell asleep does still.
  void keep_as_it_was(std::int64_t place);
  /// After all have moved: what was kept is of the last step.
  void finish();
  /// Who is pressed by hulls and lies on its like: the two are answered one after the other, and leave it a
  /// part of gravity's step, by which it does not move.
  bool stays_in_place(std::int64_t place) const;

  void archive(StateArchive& a) { a(loads_); }

 private:
  struct Load {
    std::uint32_t slot = 0, owner = 0;
    Vec3 last = Vec3::Zero();    // m/s², in the last step
    Vec3 steady = Vec3::Zero();  // m/s²: what of it was there in the step before, too
    Vec3 borne = Vec3::Zero();   // m/s²: StatisticalBody::borne in the last step
    Vec3 place = Vec3::Zero();   // m, of its centre, at the step's end
    double moved = 1e300;        // m, since the end of the one before
  };

  const Load* load_of(std::int64_t place) const;
  template <class Visit>
  void each_pressed(const Visit& visit);

  const SphereScene& scene_;
  const StatisticalSettings& settings_ = scene_.settings;
  const Spheres& spheres_ = scene_.spheres;
  const StepConstants& constants_ = scene_.constants;
  SphereStep& step_ = scene_.step;

  // By slot: of the last step's guests, and of those that were in their last step awake; of this step's.
  std::vector<Load> loads_, new_loads_;
};

}  // namespace lodestone
