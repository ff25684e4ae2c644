// Stage 3: in how many substeps those bodies move that may touch another. A pile needs them: contacts found
// once in 1/60 s miss what a body that falls into it at several m/s meets on its way, and ten sweeps over a
// pile of many layers leave it sinking into itself (a bin of 100 boxes: time to sleep three times ODE's, a
// third too low). After Macklin et al., Small steps in physics simulation, 2019. Each island, the bodies that
// may touch within the step, directly or through others, has a pace of its own: what goes on elsewhere
// changes nothing for it.
#pragma once

#include <span>
#include <vector>

#include "lod/contact/contact_scene.h"
#include "lod/contact/solid_contacts.h"
#include "lod/rungs/near_marks.h"
#include "lod/rungs/near_pairs.h"
#include "reference/disjoint_sets.h"

namespace lodestone {

class SubstepPlan {
 public:
  explicit SubstepPlan(JobRunner jobs) : jobs_(std::move(jobs)) {}

  /// For a step of `dt` seconds: marks those that may touch another, or a solid of the ground, and gives them
  /// the pace of their island.
  void make(const ContactScene& scene, const NearPairs& pairs, std::span<const SolidContact> solid_contacts,
            double dt, NearMarks& near);
  /// That any island has, in ascending order.
  std::span<const Pace> paces() const { return paces_; }

 private:
  void find_ways(const ContactScene& scene, const NearPairs& pairs, double dt);
  void mark_followers(const ContactScene& scene, const NearPairs& pairs, double dt, NearMarks& near);
  void find_islands(const ContactScene& scene, const NearPairs& pairs, const NearMarks& near);
  void find_ways_to_solids(const ContactScene& scene, std::span<const SolidContact> solid_contacts,
                           double dt);

  static constexpr double kApart = -1.0, kFollowing = -2.0;
  JobRunner jobs_;
  std::vector<double> ways_;  // of each pair, over R: how far it may close in; kApart: it may not touch;
                              // kFollowing: only once one of the two is stopped
  std::vector<std::size_t> following_;     // pairs of which neither gains on the other
  DisjointSets islands_;                   // of bodies
  std::vector<double> longest_of_island_;  // of each root: the longest of its ways
  std::vector<Pace> paces_;
};

}  // namespace lodestone
