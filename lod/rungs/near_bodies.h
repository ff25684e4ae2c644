// Stage 3d: bodies of `support` and full ones, and bodies of `tables` near them, which are guests here for a
// step. Bodies that may touch another move in substeps, in each of which contacts are found, all of them are
// solved together, and the bodies are moved. The others move by themselves.
//
// Its files: near_bodies.cpp has the sequence of a step; near_bodies_waking.cpp which sleepers wake in it;
// near_bodies_driven.cpp those that others drive too fast for what was found before.
#pragma once

#include <span>
#include <vector>

#include "lod/contact/crowd.h"
#include "lod/rungs/blows.h"
#include "lod/rungs/carried_bodies.h"
#include "lod/rungs/near_marks.h"
#include "lod/rungs/near_pairs.h"
#include "lod/rungs/near_search.h"
#include "lod/rungs/near_solids.h"
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
        solids_(ground, jobs),
        plan_(jobs),
        crowd_(jobs),
        rest_law_(settings.sleep) {
    tables_.options = settings.tables;
  }

  /// Moves the bodies of `support`, and the guests that are touched, by `dt` seconds; full neighbours receive
  /// their share of the contacts.
  void step(double dt, SupportLevel& support, std::span<Guest> guests, NearSearch& search,
            std::span<FullNeighbor> neighbors, std::span<const FullContact> full_contacts, StageTimes& times,
            ContactTally& tally);
  /// Allocates for so many bodies: little by little as bodies are added, so that no step has to.
  void make_room(std::size_t bodies) {
    pairs_.make_room(bodies), near_.make_room(bodies), crowd_.make_room(bodies);
  }
  void archive(StateArchive& a) { a(pairs_, crowd_); }
  void set_gravity(const Vec3& gravity) { settings_.gravity = gravity; }
  void set_log(ContactLog* log) { log_ = log; }  ///< null: none
  /// In place of a step in which nothing moves that could be near another.
  void forget_pairs() { pairs_.clear(), carriers_.clear(); }
  /// Kinematic bodies that touched full ones in the last step; a pair may appear more than once.
  std::span<const CarriedFull> carriers() const { return carriers_; }
  /// Contacts between bodies, as found in the last substep of each island.
  std::span<const CrowdContact> contacts() const { return pairs_.all_contacts(); }

 private:
  StepWorld world() const {
    return {settings_.gravity, ground_.planes(), &materials_, settings_.seed, settings_.properties, log_};
  }
  /// What the stages of a step work on.
  struct Step {
    double dt;  // s
    ContactScene scene;
    SupportLevel& support;
    std::span<Guest> guests;
    NearSearch& search;
    std::span<const FullContact> full_contacts;
    StageTimes& times;
    ContactTally& tally;
  };
  void plan_substeps(const Step& step);
  void move_lone(const Step& step);
  void move_islands(const Step& step, Pace pace);
  void find_touching(const Step& step, Pace pace, int substep);
  void choose_movers(const SupportLevel& support, Pace pace);
  void move_alone(const Step& step, double time);
  FacesUnder faces_under(const ContactScene& scene, std::int32_t index, const Vec3& along, double time) const;
  void move_alone(SupportLevel& support, std::span<Guest> guests, std::int32_t index, double time,
                  ContactTally& tally, const FacesUnder& under, const Quat* turned) const;
  void move_on_solids(const Step& step, double time);
  void move_crowded(const Step& step, Pace pace, int substep);
  void take_crowded(const Step& step);
  void move_full_on(double time, int substep);
  void give_back(std::span<FullNeighbor> neighbors) const;
  void find_carriers(const ContactScene& scene);

  // Waking.
  static void keep_awake(const Step& step, Participant p);
  void wake(const Step& step, Participant p, Pace pace);
  void wake_touched(const Step& step, Pace pace);
  void find_inside(const ContactScene& scene);
  bool are_to_part(const ContactScene& scene, const CrowdContact& contact) const;
  void keep_awake_on_moving_ground(const Step& step);
  void look_up_woken(const Step& step, double elapsed);
  void meet_woken(const Step& step, Pace pace, int substep);

  // Those that others drive.
  void note_ball(const Step& step, Participant p, double elapsed);
  void find_driven(const Step& step, double left);
  void note_places(const Step& step);
  void stop_before_unseen_ground(const Step& step);

  StatisticalSettings settings_;
  const Ground& ground_;
  const MaterialTable& materials_;
  const Kinds& kinds_;
  JobRunner jobs_;
  TablesSettings tables_;
  ContactLog* log_ = nullptr;

  NearPairs pairs_;
  NearSolids solids_;
  NearMarks near_;
  SubstepPlan plan_;
  Crowd crowd_;
  RestLaw rest_law_;
  CarriedBodies carried_;
  Blows blows_;
  std::vector<std::pair<std::int32_t, Vec3>> places_;  // of those that touch others, before they are moved
  std::vector<std::int32_t> movers_;                   // indices: who is awake and moves at the pace in hand
  std::vector<Participant> woken_;                     // by contacts, those that were found or solved last
  std::vector<Participant> struck_;                    // of these, those that blows reach through others
  std::vector<Participant> driven_;                    // out of their balls, in the substep before
  std::vector<NearSearch::Ball> balls_;           // of each statistical body that is near others, by index
  std::vector<Participant> inside_;               // others, so deep that these were added there
  std::vector<FullNeighbor> full_, full_before_;  // the neighbours, moved on between substeps
  std::vector<std::int32_t> known_movers_;
  std::vector<std::pair<std::int32_t, Vec3>> on_solids_;  // indices; m/s, of the ground there, if it goes on
  std::vector<CarriedFull> carriers_;
  std::vector<ContactTally> tallies_;
};

}  // namespace lodestone
