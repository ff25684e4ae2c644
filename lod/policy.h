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

/// As many of the nearest bodies full as fit `budget_ms` of a step, by the measured cost of a full body-step.
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
enum class LevelReason : std::uint8_t { forced, near, far, within_hysteresis, dwell, queued, over_budget, in_budget, overlap_put_off, contact_group };
std::string_view text_of(LevelReason reason);

/// What the policy looks at, one per body.
struct LevelCandidate {
  Vec3 position = Vec3::Zero();
  double importance = 1.0;
  LevelChoice choice = LevelChoice::automatic;
  Level level = Level::statistical;
  std::int32_t frames_since_change = 1 << 30;
};

struct LevelDecision {
  std::vector<std::int32_t> promote, demote;  ///< candidate indices, in order of urgency, at most max_transitions_per_frame in all (forced ones are not limited)
  std::vector<LevelReason> reasons;           ///< one per candidate
};

/// `full_body_step_ms`: measured mean cost of one full body for one step (budget policy). `statistical_ms`: measured cost of the statistical level's step.
LevelDecision choose_levels(std::span<const LevelCandidate> candidates, std::span<const Vec3> viewpoints, const PolicySettings& settings,
                            double full_body_step_ms, double statistical_ms);

}  // namespace lodestone
