// Stage 1 of a step: which rungs the policy wants. It is asked about those bodies alone for which its answer
// may have changed: those that are full, awake, new, put off or changed by the caller, and of those that
// sleep the ones whose turn it is (far_bodies.h). The others keep the rung and the reason that they have, and
// the decision is the one that it would be of all.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "lod/manager/change_pause.h"
#include "lod/manager/choose_levels.h"
#include "lod/manager/cost_model.h"
#include "lod/manager/far_bodies.h"
#include "lod/manager/full_carriers.h"
#include "lod/manager/groups.h"
#include "lod/manager/levels.h"
#include "lod/manager/views.h"
#include "lod/step_report.h"
#include "reference/state_archive.h"

namespace lodestone {

/// What a step shall change.
struct RungChanges {
  struct Change {
    std::uint32_t body = 0;
    Rung to = Rung::support;
    RungSet open = kEveryRung;
    /// Those that follow each other with the same number change all or not at all.
    std::int32_t together = -1;
  };
  std::vector<Change> promote, demote;
};

/// Why a body has one rung alone that is open to it, by its own settings.
Rule rule_for_one(const BodyLevel& level);

class Choose {
 public:
  /// `model`: that all statistical bodies have which the caller leaves to the manager.
  Choose(Levels& levels, const PolicySettings& policy, std::optional<StatisticalModel> model)
      : levels_(levels),
        groups_(levels),
        carriers_(levels),
        policy_(policy),
        limits_(limits_of(policy)),
        model_(model) {}

  Groups& groups() { return groups_; }
  const Groups& groups() const { return groups_; }

  const PolicySettings& policy() const { return policy_; }
  const Views& views() const { return views_; }
  void set_policy(const PolicySettings& policy);
  void set_views(Views views);
  /// The caller, or a change of rung, did something to it: it is looked at in the next step.
  void note(std::uint32_t body) { changed_.push_back(body); }
  void forget(std::uint32_t body) { far_.forget(body), groups_.forget(body), carriers_.forget(body); }
  /// Kinematic bodies that touched full ones in a step.
  void note_carriers(std::span<const CarriedFull> touches) {
    for (const CarriedFull& touch : touches)
      if (carriers_.take(touch)) note(touch.carrier);
  }

  /// Nothing: all stay as they are. What was decided and not done, because the step threw, is decided anew:
  /// see done().
  std::optional<RungChanges> run(StepReport& report, CostModel& costs);
  void done() { look_at_all_ = false; }
  /// Of the bodies that wait for their signature, those for whom it has come, a few in each step: `supply` is
  /// called with those at `support`. One for whom it throws waits on.
  void supply_waiting(const std::function<void(std::uint32_t)>& supply);

  /// Bodies that it saw, on the rungs that they have after its decision.
  const StepCounts& counts() const { return counts_; }
  /// px: of those that it saw and that are awake, on the rungs that they have after its decision; under an
  /// error budget.
  double predicted_error() const { return predicted_error_; }
  /// Where a body is and how it is seen, as the policy has it now; without costs.
  LevelCandidate seen(std::uint32_t body) const;
  /// Of a body as it is now.
  Activity activity(std::uint32_t body) const;
  /// Steps for which a body keeps its rung.
  std::int32_t dwell_left(std::uint32_t body) const;
  bool in_view(const Vec3& center, double radius) const;
  /// px: diameter of its bounding sphere in the picture where it is largest; 0 without viewpoints.
  double pixels(const LevelCandidate& seen) const;
  /// What full bodies do, after the changes.
  void count_meetings();

  /// But for the policy and the ground, which are the reader's: what another policy wanted is not believed.
  void archive(StateArchive& a);

 private:
  /// What a body's rung depends on, besides where it is.
  struct Circumstances {
    Activity does = Activity::alone;
    RungSet open = kEveryRung;  // the rungs that it may be on
    bool pinned = false;        // full as long as joints hold it there
    bool held = false;          // pinned, and awake
    bool carries = false;       // a kinematic body that touches an awake full one
    float mesh = 0.0f;          // weight of its mesh in pairs of full bodies, under a budget
    bool asleep() const { return does == Activity::asleep; }
  };

  bool budgeted() const { return !limits_; }
  bool by_error() const { return std::holds_alternative<ErrorBudgetPolicy>(policy_.policy); }
  bool sees_places() const;
  void look_at_those_concerned(StepReport& report);
  void look_at(std::uint32_t body, StepReport& report);
  void look_at_nearest(StepReport& report);
  double due_asleep(std::uint32_t body) const;
  double distance_to_views(const Vec3& position) const;
  void ask_for_signature(std::uint32_t body, const BodyLevel& level);
  Circumstances find_circumstances(std::uint32_t body, const BodyLevel& level);
  void count_present(const BodyLevel& level, const Circumstances& is);
  void price(std::uint32_t body, const BodyLevel& level, const Circumstances& is, LevelCandidate& candidate);
  bool stays_as_it_is(const BodyLevel& level, const LevelCandidate& candidate) const;
  RungSet open_to(const BodyLevel& level, bool asleep) const;
  RungSet open_by_choice(const BodyLevel& level, bool asleep) const;
  LevelCandidate make_candidate(std::uint32_t body, RungSet open, bool asleep);
  void look_ahead();
  void look_ahead(LevelCandidate& candidate, std::span<const std::size_t> full) const;
  double significance(std::uint32_t body) const;
  void predict_errors(std::uint32_t body, Activity does, LevelCandidate& candidate) const;
  void count(Rung rung, Activity does, bool arriving, float mesh, double bodies);
  void count_held(Activity does, double share);
  bool arrives(const BodyLevel& level, Activity does) const;
  double awake_pairs() const;
  void ask_for_tables(std::uint32_t body);
  void note_waiting(std::uint32_t body);
  void put_far(std::uint32_t body, const LevelCandidate& candidate);
  void put_in_order();
  std::span<const LevelCandidate> make_units();
  void count_pairs_within();
  bool comes_to_rest() const;
  LevelDecision decide();
  LevelDecision tell_members(const LevelDecision& of_all);
  RungChanges take_answers(const LevelDecision& decision);
  Rung below_full(RungSet open) const;
  void count_changes(const RungChanges& changes);
  void add_up_errors(const RungChanges& changes);

  Levels& levels_;
  Groups groups_;
  FullCarriers carriers_;
  PolicySettings policy_;
  std::optional<Limits> limits_;  // of the policy, but for a budget
  std::optional<StatisticalModel> model_;
  Views views_;
  bool turned_ = false;  // a view, since the last step
  bool look_at_all_ = true;
  std::vector<std::uint32_t> wishing_;           // that did not get the rung that is wanted for them
  std::vector<std::uint32_t> changed_;           // by the caller, or by a change of rung
  std::vector<std::uint32_t> support_sleepers_;  // that may go down to `tables`, under a budget
  std::vector<std::uint32_t> seen_or_not_;       // sleepers whose rung depends on whether they are in view
  std::vector<std::uint32_t> waiting_;           // for their signature
  std::size_t next_waiting_ = 0;                 // to be asked about
  std::vector<std::uint32_t> concerned_;         // this step
  FarBodies far_;
  ChangePause pause_;
  double traveled_ = 0.0;             // m: how far viewpoints came, at most
  std::vector<std::uint32_t> asked_;  // bodies of the candidates
  std::vector<LevelCandidate> candidates_;
  std::vector<std::int32_t>
      unit_of_;  // of each candidate: what it changes rung with, below; empty: each is alone
  std::vector<LevelCandidate> units_;
  std::vector<Activity> activities_;  // of the candidates, under a budget
  // While they are put in order.
  std::vector<std::uint32_t> order_;
  std::vector<LevelCandidate> ordered_;
  std::vector<Activity> activities_in_order_;
  StepCounts counts_;
  double full_in_crowd_ = 0.0;    // bodies
  double predicted_error_ = 0.0;  // px
  CostModel* costs_ = nullptr;    // of this step
};

}  // namespace lodestone
