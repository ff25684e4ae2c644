// Stage 3d: in how many substeps bodies move that may touch another (Macklin et al., Small steps in physics
// simulation, 2019).
//
// A pile needs substeps. If contacts are found once in 1/60 s, a body that falls into it at several m/s
// passes what it should meet on its way; and ten sweeps over a pile of many layers leave it sinking into
// itself (a bin of 100 boxes takes three times as long as ODE's to sleep, and is a third too low). A heap
// that has slowed down meets nothing new on its way: it takes the step at once, with the sweeps of three
// substeps.
//
// An island is the bodies that may touch within the step, directly or through others. Each has a pace of its
// own, so that nothing elsewhere affects it. But all islands with sleepers or full bodies count as one, since
// these may wake, or pass on impulses.
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

/// Sweeps of the contact solver in each substep, at most.
inline int sweeps_of(Pace pace) { return std::max(10, 30 / pace); }
/// By how much more than push_out_overlap says a substep undoes overlaps: a step taken at once then undoes
/// nearly as much as three substeps.
inline double parting_of(Pace pace) { return pace == 1 ? 1.6 : 1.0; }

class SubstepPlan {
 public:
  explicit SubstepPlan(JobRunner jobs) : jobs_(std::move(jobs)) {}

  /// For a step of `dt` seconds: marks the bodies that may touch another, or a solid of the ground, and gives
  /// them the pace of their island. It does not mark a hull that touches only ground that stands still, or
  /// moves as a whole without turning.
  void make(const ContactScene& scene, const NearPairs& pairs, std::span<const SolidContact> solid_contacts,
            const FacesBelow& faces, double dt, NearMarks& near);
  /// The paces of all islands, each once, ascending.
  std::span<const Pace> paces() const { return paces_; }

 private:
  static constexpr double kApart = -1.0, kFollowing = -2.0;
  struct Island {
    double longest = kApart;  // over R: greatest PairWay::along
    double fall = 0.0;        // over R: what gravity adds to the way of its smallest body in the step
    int bodies = 0;           // number of bodies that are awake
    bool is_hard = false;     // sweeps of three substeps are not enough for a step at once
  };

  /// What the plan needs of a pair, in an array of their own, as the pairs themselves lie far apart in
  /// memory.
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
