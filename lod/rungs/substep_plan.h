// Stage 3d: in how many substeps those bodies move that may touch another. A pile needs them: contacts found
// once in 1/60 s miss what a body that falls into it at several m/s meets on its way, and ten sweeps over a
// pile of many layers leave it sinking into itself (a bin of 100 boxes: time to sleep three times ODE's, a
// third too low). After Macklin et al., Small steps in physics simulation, 2019. A heap that has slowed down
// meets nothing new on its way: it takes the step at once, with the sweeps of three substeps. Each island,
// the bodies that may touch within the step, directly or through others, has a pace of its own: what goes on
// elsewhere changes nothing for it. (But all that touches sleepers or full bodies is one island, since these
// may wake, or hand on what they are given.)
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "lod/contact/contact_scene.h"
#include "lod/contact/solid_contacts.h"
#include "lod/rungs/near_marks.h"
#include "lod/rungs/near_pairs.h"
#include "reference/disjoint_sets.h"

namespace lodestone {

/// Of the contact solver, at most, in each substep.
inline int sweeps_of(Pace pace) { return std::max(10, 30 / pace); }
/// Of overlaps, how much of what a substep undoes elsewhere (push_out_overlap): at once nearly as much is
/// undone in a step as in three substeps.
inline double parting_of(Pace pace) { return pace == 1 ? 1.6 : 1.0; }

class SubstepPlan {
 public:
  explicit SubstepPlan(JobRunner jobs) : jobs_(std::move(jobs)) {}

  /// For a step of `dt` seconds: marks those that may touch another, or a solid of the ground, and gives them
  /// the pace of their island. A hull that touches nothing but ground that stands still, or goes on as one
  /// without turning, is not marked.
  void make(const ContactScene& scene, const NearPairs& pairs, std::span<const SolidContact> solid_contacts,
            const FacesBelow& faces, double dt, NearMarks& near);
  /// That any island has, in ascending order.
  std::span<const Pace> paces() const { return paces_; }

 private:
  static constexpr double kApart = -1.0, kFollowing = -2.0;
  struct Island {
    double longest = kApart;  // of its ways
    double fall = 0.0;        // over R: what gravity adds to the way of its smallest body in the step
    int bodies = 0;           // that are awake
    bool is_hard = false;     // sweeps of three substeps are not enough for a step at once
  };

  /// What the plan asks of a pair, side by side: the pairs themselves lie far apart.
  struct PairWay {
    Participant first = Participant::ground(), second = Participant::ground();
    bool first_is_other = false, second_is_other = false;  // full, or asleep
    bool is_hard = false;                                  // as Island
    double along = kApart;  // over R: how far it may close in; kApart: it may not touch; kFollowing: only
                            // once one of the two is stopped
  };
  static void mark(const PairWay& way, NearMarks& near) { near.mark(way.first), near.mark(way.second); }

  void find_ways(const ContactScene& scene, const NearPairs& pairs, double dt);
  void mark_followers(const ContactScene& scene, const NearPairs& pairs, const FacesBelow& faces, double dt,
                      NearMarks& near);
  void find_islands(const ContactScene& scene, double dt, const NearMarks& near);
  void find_ways_to_solids(const ContactScene& scene, std::span<const SolidContact> solid_contacts, double dt,
                           const NearMarks& near);
  Island& island_of(std::int32_t node) { return island_of_root_[std::size_t(islands_.root_of(node))]; }

  JobRunner jobs_;
  std::vector<PairWay> ways_;           // of each pair
  std::vector<std::size_t> following_;  // pairs of which neither gains on the other
  std::vector<std::pair<std::size_t, std::size_t>> following_of_;  // each body's, in order
  std::vector<std::int32_t> striking_;  // slots of those alone on parts of the ground against which they move
  std::vector<std::size_t> stopped_;    // bodies whose pairs are still to be looked at
  DisjointSets islands_;                // of bodies
  std::vector<Island> island_of_root_;  // of each body, where it stands for its island
  std::vector<Pace> paces_;
};

}  // namespace lodestone
