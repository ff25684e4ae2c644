// Stages 3 to 5 for hulls: bodies of `support` and full ones, and those of `tables` near them, which are
// guests here for a step. Who may touch another moves in substeps: contacts found, all of them solved at
// once, the bodies moved; the others move by themselves.
#pragma once

#include <span>
#include <vector>

#include "lod/contact/crowd.h"
#include "lod/rungs/near_marks.h"
#include "lod/rungs/near_pairs.h"
#include "lod/rungs/near_search.h"
#include "lod/rungs/substep_plan.h"
#include "lod/statistical/rest_law.h"
#include "lod/step_report.h"
#include "lod/support/support_level.h"
#include "lod/tables/guest.h"
#include "reference/state_archive.h"

namespace lodestone {

class NearBodies {
 public:
  NearBodies(const StatisticalSettings& settings, const Ground& ground, const MaterialTable& materials,
             const Kinds& kinds, const JobRunner& jobs)
      : settings_(settings),
        ground_(ground),
        materials_(materials),
        kinds_(kinds),
        jobs_(jobs),
        pairs_(jobs),
        crowd_(jobs),
        rest_law_(settings.sleep) {
    tables_.options = settings.tables;
  }

  /// Moves the bodies of `support`, and the guests that are touched, by `dt` seconds; full neighbours receive
  /// their share of the contacts.
  void step(double dt, SupportLevel& support, std::span<Guest> guests, NearSearch& search,
            std::span<FullNeighbor> neighbors, std::span<const FullContact> full_contacts, StageTimes& times,
            ContactTally& tally);
  /// As bodies are added, little by little, so that no step has to.
  void make_room(std::size_t bodies) {
    pairs_.make_room(bodies), near_.make_room(bodies), crowd_.make_room(bodies);
  }
  void archive(StateArchive& a) { a(pairs_, crowd_); }
  void set_gravity(const Vec3& gravity) { settings_.gravity = gravity; }
  void set_log(ContactLog* log) { log_ = log; }  ///< null: none
  /// In place of a step, where nothing moves that could be near another.
  void forget_pairs() { pairs_.clear(); }
  /// Between bodies, found in the last substep.
  std::span<const CrowdContact> contacts() const { return pairs_.contacts(); }

 private:
  StepWorld world() const {
    return {settings_.gravity, ground_.planes(), &materials_, settings_.seed, settings_.properties, log_};
  }
  void find_ground_solids(const ContactScene& scene, const SupportLevel& support, double after, double time,
                          bool of_near_only);
  template <class Select>
  void move_those(SupportLevel& support, std::span<Guest> guests, double time, ContactTally& tally,
                  const Select& select);
  void move_alone(SupportLevel& support, std::span<Guest> guests, std::int32_t index, double time,
                  ContactTally& tally) const;
  void wake_touched(const ContactScene& scene, SupportLevel& support);
  void move_crowded(const ContactScene& scene, SupportLevel& support, std::span<Guest> guests,
                    std::span<const FullContact> full_contacts, double time, ContactTally& tally);
  void move_on(double time, int substep);

  StatisticalSettings settings_;
  const Ground& ground_;
  const MaterialTable& materials_;
  const Kinds& kinds_;
  JobRunner jobs_;
  TablesSettings tables_;
  ContactLog* log_ = nullptr;
  double step_s_ = 0.0;  // s, of the whole step

  NearPairs pairs_;
  NearMarks near_;
  SubstepPlan plan_;
  Crowd crowd_;
  RestLaw rest_law_;
  std::vector<FullNeighbor> full_, full_before_;  // the neighbours, moved on between substeps
  std::vector<SolidContact> solid_contacts_;
  FacesBelow faces_;
  std::vector<ContactTally> tallies_;
};

}  // namespace lodestone
