// Stage 1 of a step: which rungs the policy wants. It is asked about those bodies alone for which its answer may have changed: those that are full, awake, new,
// put off or changed by the caller, and of those that sleep the ones whose turn it is (far_bodies.h). The others keep the rung and the reason that they have, and the
// decision is the one that it would be of all.
#pragma once

#include <Eigen/Geometry>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "lod/manager/choose_levels.h"
#include "lod/manager/cost_model.h"
#include "lod/manager/far_bodies.h"
#include "lod/manager/levels.h"
#include "lod/step_report.h"

namespace lodestone {

/// What a step shall change.
struct RungChanges {
  struct Change {
    std::uint32_t body = 0;
    Rung to = Rung::support;
    RungSet open = kEveryRung;
  };
  std::vector<Change> promote, demote;
};

class Choose {
 public:
  /// `model`: that all statistical bodies have which the caller leaves to the manager.
  Choose(Levels& levels, const PolicySettings& policy, std::optional<StatisticalModel> model) : levels_(levels), policy_(policy), model_(model) {}

  const PolicySettings& policy() const { return policy_; }
  void set_policy(const PolicySettings& policy);
  void set_viewpoints(std::span<const Vec3> positions);
  /// Of a static box or mesh.
  void add_static_bounds(const Eigen::AlignedBox3d& bounds);
  /// The caller, or a change of rung, did something to it: it is looked at in the next step.
  void note(std::uint32_t body) { changed_.push_back(body); }
  void forget(std::uint32_t body) { far_.forget(body); }

  /// Nothing: all stay as they are. What was decided and not done, because the step threw, is decided anew: see done().
  std::optional<RungChanges> run(StepReport& report, CostModel& costs);
  void done() { look_at_all_ = false; }

  /// Bodies that it saw, on the rungs that they have after its decision.
  const StepCounts& counts() const { return counts_; }
  /// What full bodies do, after the changes.
  void count_meetings();

 private:
  bool budgeted() const { return !std::holds_alternative<DistancePolicy>(policy_.policy); }
  bool sees_places() const;
  void look_at_those_concerned(StepReport& report);
  void look_at(std::uint32_t body, StepReport& report);
  void look_at_nearest(StepReport& report);
  RungSet open_to(const BodyLevel& level, bool asleep) const;
  void close_tables_near_static_ground(std::uint32_t body, LevelCandidate& candidate) const;
  LevelCandidate make_candidate(std::uint32_t body, RungSet open, bool asleep) const;
  Activity activity(const BodyRecord& record) const;
  void count(Rung rung, Activity does, bool arriving, double bodies);
  bool arrives(const BodyLevel& level, Activity does) const;
  void ask_for_tables(std::uint32_t body);
  void note_waiting(std::uint32_t body);
  void put_far(std::uint32_t body, const LevelCandidate& candidate);
  void put_in_order();
  RungChanges take_answers(const LevelDecision& decision);
  Rung below_full(RungSet open) const;
  void count_changes(const RungChanges& changes);

  Levels& levels_;
  PolicySettings policy_;
  std::optional<StatisticalModel> model_;
  std::vector<Vec3> viewpoints_;
  std::vector<Eigen::AlignedBox3d> static_bounds_;  // of the static boxes and meshes
  bool look_at_all_ = true;
  std::vector<std::uint32_t> wishing_;              // that did not get the rung that is wanted for them
  std::vector<std::uint32_t> changed_;              // by the caller, or by a change of rung
  std::vector<std::uint32_t> support_sleepers_;     // that may go down to `tables`, under a budget
  FarBodies far_;
  double traveled_ = 0.0;                           // m: how far viewpoints came, at most
  std::vector<std::uint32_t> asked_;                // bodies of the candidates
  std::vector<LevelCandidate> candidates_;
  std::vector<Activity> activities_;                // of the candidates, under a budget
  std::array<std::array<float, kRungs>, kActivities> cost_of_{};  // of one body, under a budget
  StepCounts counts_;
  CostModel* costs_ = nullptr;                      // of this step
};

}  // namespace lodestone
