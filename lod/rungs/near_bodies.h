// Stages 3 to 5 for hulls: bodies of `support` and full ones, and those of `tables` near them, which are guests here for a step. Who may touch another moves in substeps: contacts
// found, all of them solved at once, the bodies moved; the others move by themselves.
#pragma once

#include <span>
#include <vector>

#include "lod/contact/crowd.h"
#include "lod/rungs/near_marks.h"
#include "lod/rungs/near_pairs.h"
#include "lod/rungs/near_search.h"
#include "lod/rungs/substep_plan.h"
#include "lod/step_report.h"
#include "lod/support/support_level.h"
#include "lod/tables/guest.h"

namespace lodestone {

class NearBodies {
 public:
  NearBodies(const StatisticalSettings& settings, const StaticGround& ground, const MaterialTable& materials, const Kinds& kinds, const JobRunner& jobs)
      : settings_(settings), ground_(ground), materials_(materials), kinds_(kinds), jobs_(jobs), pairs_(jobs), crowd_(jobs) {
    tables_.options = settings.tables;
  }

  /// Moves the bodies of `support`, and the guests that are touched, by `dt` seconds; full neighbours receive their share of the contacts.
  void step(double dt, SupportLevel& support, std::span<Guest> guests, NearSearch& search, std::span<FullNeighbor> neighbors, std::span<const FullContact> full_contacts,
            StageTimes& times, ContactTally& tally);
  /// As bodies are added, little by little, so that no step has to.
  void make_room(std::size_t bodies) { pairs_.make_room(bodies), near_.make_room(bodies), crowd_.make_room(bodies); }
  /// In place of a step, where nothing moves that could be near another.
  void forget_pairs() { pairs_.clear(); }

 private:
  StepWorld world() const { return {settings_.gravity, &ground_, &materials_, settings_.seed}; }
  void find_ground_solids(const ContactScene& scene, const SupportLevel& support, double time, bool of_near_only);
  template <class Select>
  void move_those(SupportLevel& support, std::span<Guest> guests, double time, ContactTally& tally, const Select& select);
  void move_alone(SupportLevel& support, std::span<Guest> guests, std::int32_t index, double time, ContactTally& tally) const;
  void wake_touched(const ContactScene& scene, SupportLevel& support);
  void move_crowded(const ContactScene& scene, SupportLevel& support, std::span<Guest> guests, std::span<const FullContact> full_contacts, double time, ContactTally& tally);
  void move_on(double time, int substep);

  StatisticalSettings settings_;
  const StaticGround& ground_;
  const MaterialTable& materials_;
  const Kinds& kinds_;
  JobRunner jobs_;
  TablesSettings tables_;
  double step_s_ = 0.0;                           // s, of the whole step

  NearPairs pairs_;
  NearMarks near_;
  SubstepPlan plan_;
  Crowd crowd_;
  std::vector<FullNeighbor> full_, full_before_;  // the neighbours, moved on between substeps
  std::vector<SolidContact> solid_contacts_;
  FacesBelow faces_;
  std::vector<ContactTally> tallies_;
};

}  // namespace lodestone
