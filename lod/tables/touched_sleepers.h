// Bodies that touch sleepers, and whom they wake.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "lod/broad_phase/cell_grid.h"
#include "lod/broad_phase/still_grid.h"
#include "lod/jobs.h"
#include "lod/statistical/blow_reach.h"
#include "lod/tables/sphere_scene.h"

namespace lodestone {

class TouchedSleepers {
 public:
  /// `still`: those asleep, by slot.
  TouchedSleepers(const SphereScene& scene, const StillGrid& still) : scene_(scene), still_(still) {}

  /// First the pairs of awake bodies, whose balls are in `cells` by their places, and sleepers.
  void find_pairs(const CellGrid& cells);
  /// Then, when the awake bodies' other contacts have been found, those of the pairs that touch. Calls
  /// wake(slot) for those that are hit hard enough.
  void find(TaskRef wake);
  /// Places of who touches, and of who slept when find() began.
  std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs() const { return pairs_; }
  void forget_left_asleep() { left_asleep_.clear(); }
  /// Of those that are touched too gently to be woken, only those by whom is_drawn(place).
  template <class IsDrawn>
  void keep_left_asleep(const IsDrawn& is_drawn) {
    std::erase_if(left_asleep_, [&](const Touch& touch) { return !is_drawn(touch.place); });
  }
  void wake_left_asleep(TaskRef wake);

  std::size_t bytes() const { return pairs_.capacity() * sizeof pairs_[0]; }

 private:
  struct Touch {
    std::int64_t place;  // awake
    std::uint32_t slot;  // asleep
    Vec3 normal;         // into the one awake
  };
  void look_around_awake();
  void look_around_sleepers(const CellGrid& cells);
  double reach_of_sleeper(std::int64_t place) const;
  void wake_struck(TaskRef wake);
  bool any_blow() const;
  std::int32_t add_body(std::int64_t place);

  const SphereScene& scene_;
  const StillGrid& still_;
  const StatisticalSettings& settings_ = scene_.settings;
  const RestLaw& rest_law_ = scene_.rest_law;
  const SphereKinds& kinds_ = scene_.kinds;
  const StepConstants& constants_ = scene_.constants;
  const SphereStep& step_ = scene_.step;
  const Spheres& spheres_ = scene_.spheres;
  const SphereContacts& contacts_ = scene_.contacts;

  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs_;  // place awake, slot asleep; then both places
  std::vector<Touch> left_asleep_;  // those of them that touch too gently to wake the sleeper
  BlowReach blows_;
  std::vector<std::int32_t> numbered_;  // of each place awake: its number there; −1: none
  std::vector<std::int64_t> places_;    // of each number
  std::vector<std::uint32_t> struck_slots_;
};

}  // namespace lodestone
