// Which level each body should have: by distance from the viewpoints, or by what a step may cost. Pure: no simulation here.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include "lod/body.h"

namespace lodestone {

/// Full within `full_within` metres (times importance) of the nearest viewpoint; statistical again beyond that times (1 + hysteresis).
struct DistancePolicy {
  double full_within = 4.0;  ///< m
};

/// As many of the nearest bodies full as fit `budget_ms` of a step, by the measured cost of a full body-step. Bodies are promoted only
/// while 1 / (1 + hysteresis) of the budget is not used up, and demoted only beyond the whole of it, or for one that is clearly nearer.
struct BudgetPolicy {
  double budget_ms = 4.0;
};

struct PolicySettings {
  std::variant<DistancePolicy, BudgetPolicy> policy;
  double hysteresis = 0.1;            ///< fraction of the distance
  int min_dwell_frames = 30;          ///< a body keeps a new level at least this long
  int max_transitions_per_frame = 4;  ///< nearest first; the rest wait their turn
};

/// Why a body has its level.
enum class LevelReason : std::uint8_t { forced, near, far, within_hysteresis, dwell, queued, over_budget, in_budget, overlap_put_off, contact_group, static_ground, signature_pending };
std::string_view text_of(LevelReason reason);

/// What the policy looks at, one per body.
struct LevelCandidate {
  Vec3 position = Vec3::Zero();
  double radius = 0.0;      ///< m, distance is measured to the nearest point of the bounding sphere
  double importance = 1.0;
  LevelChoice choice = LevelChoice::automatic;
  Level level = Level::statistical;
  bool on_static_ground = false;  ///< near static boxes or meshes, which its model does not meet
  bool waits_for_signature = false;  ///< the statistical level cannot have it yet
  bool newcomer = false;    ///< at no level yet: takes its level now, whatever the dwell and the cap
  bool put_off = false;     ///< its promotion was put off lately: it waits as it is
  std::int32_t frames_since_change = 1 << 30;

  /// Whether the policy has no say.
  bool decided() const { return choice != LevelChoice::automatic || on_static_ground || waits_for_signature; }
  bool must_be_full() const { return choice == LevelChoice::full || waits_for_signature || (choice == LevelChoice::automatic && on_static_ground); }
};

struct LevelDecision {
  /// Candidate indices. Forced ones, newcomers and demotions that bring the cost back within the budget come first and are not limited;
  /// of the rest at most max_transitions_per_frame, promotions (nearest first) and demotions (farthest first) by turns.
  std::vector<std::int32_t> promote, demote;
  std::vector<LevelReason> reasons;  ///< one per candidate
};

/// The distance of a body is its distance from the nearest viewpoint, less its radius, over its importance; without viewpoints it is infinite.
/// `full_body_step_ms`: measured mean cost of one full body for one step (budget policy). `statistical_ms`: measured cost of the statistical
/// level's step. Measured times differ from run to run and so do the levels that a BudgetPolicy chooses.
LevelDecision choose_levels(std::span<const LevelCandidate> candidates, std::span<const Vec3> viewpoints, const PolicySettings& settings,
                            double full_body_step_ms, double statistical_ms);

// Which bodies may be left out of the candidates without any change to the decision. Under a DistancePolicy: statistical ones that stays_far, and those that
// were told to be what they are. Under a BudgetPolicy: statistical ones at a greater rank_distance than as many others as count_wanted.

/// Whether a statistical body is surely farther than it would have to be to become full.
bool stays_far(const LevelCandidate& candidate, std::span<const Vec3> viewpoints, double full_within);
/// m: full bodies count as nearer by the hysteresis.
double rank_distance(const LevelCandidate& candidate, std::span<const Vec3> viewpoints, double hysteresis);
/// How many automatic bodies a budget wants full. Every body that is full or must be is among the candidates.
std::int64_t count_wanted(std::span<const LevelCandidate> candidates, const BudgetPolicy& policy, double hysteresis, double full_body_step_ms,
                          double statistical_ms);

}  // namespace lodestone
