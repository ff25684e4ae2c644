// Which rung each body should have: by distance from the viewpoints, by size in their pictures, or by what a
// step may cost. Numbers out of their ranges throw InputError.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <variant>

#include "lod/body.h"

namespace lodestone {

/// Full within `full_within` metres (times importance) of the nearest viewpoint, `support` within
/// `support_within`, `tables` beyond; a lower rung again only beyond the distance times (1 + hysteresis).
struct DistancePolicy {
  double full_within = 4.0;                                         ///< m, ≥ 0
  double support_within = std::numeric_limits<double>::infinity();  ///< m, ≥ full_within
};

/// By the diameter of a body's bounding sphere in the picture of the viewpoint where it is largest, times
/// importance: full above `full_above_px`, `support` above `support_above_px`, `tables` below; a lower rung
/// again only below the size over (1 + hysteresis).
struct ProjectedSizePolicy {
  double full_above_px = 50.0;    ///< ≥ 0
  double support_above_px = 0.0;  ///< 0 … full_above_px; 0: no body is on a lower rung
};

/// What a whole step may cost, in processor time of the calling thread: choice, transfer, all three rungs and
/// what they have to do with each other. The nearest bodies are full, the next ones `support`, the others
/// `tables`, as many as are predicted to fit; the prediction is learnt from measured steps, so the levels
/// differ from run to run. After it had to send bodies down, the others keep their rungs for 8 steps; up to
/// 128 where that happens again while the viewpoints stay within a metre.
struct BudgetPolicy {
  double budget_ms = 4.0;  ///< ≥ 0
};

/// The same with work that is counted, not timed: the same levels in every run and on every machine. A unit
/// is about a microsecond (see RungCost::work).
struct WorkPolicy {
  double budget_work = 4000.0;  ///< units a step, ≥ 0
};

/// A budget that is spent where it buys most: a higher rung goes to those bodies first whose error in the
/// picture (Why::predicted_error_pixels, times importance) it lessens most for what it costs. A rung's error
/// comes with the shape's signature where it was measured (`lodestone compare errors SHAPE --keep`), else it
/// is an average (RungErrors).
struct ErrorBudgetPolicy {
  double budget_ms = 4.0;                  ///< ≥ 0
  std::optional<double> budget_work = {};  ///< in its place, ≥ 0: counted, not timed
};

inline constexpr int kUnlimited = std::numeric_limits<int>::max();

struct PolicySettings {
  std::variant<DistancePolicy, BudgetPolicy, WorkPolicy, ProjectedSizePolicy, ErrorBudgetPolicy> policy;
  double hysteresis = 0.1;    ///< ≥ 0, as a part of the distance or size
  int min_dwell_frames = 30;  ///< steps, ≥ 0: a body keeps a new rung at least this long
  /// Changes of rung in a step, ≥ 0, nearest first; the rest wait their turn. It does not count those of new
  /// bodies, those that the caller forces, and those that bring bodies back within a limit or a budget.
  int max_transitions_per_frame = 4;
  int most_full = kUnlimited;     ///< ≥ 0: so many bodies at most does the policy keep full, the nearest
  int most_support = kUnlimited;  ///< ≥ 0: and so many awake ones at `support`
  /// ≥ 1: a body in no viewpoint's picture counts as so many times as far; infinity: it goes to the least
  /// rung that it may have.
  double out_of_view_factor = 1.0;
  /// Whether a sphere (m, world) is in view; empty: whether it meets the frustum of any viewpoint. It is
  /// called in every step for each body for which that makes a difference. Neither it nor `significance` may
  /// change the manager.
  std::function<bool(const Vec3& center, double radius)> visible = {};
  /// A factor of a body's importance, limited to 1e-3 … 1. It is called for the bodies that a step considers:
  /// those that are full or awake, and now and then a sleeper.
  std::function<double(BodyId)> significance = {};
  /// s, 0 … 10: a body that moves farther than its radius in this time counts as being as near as it will
  /// come within it, and as near as the full body that it will hit: so it is promoted before.
  double look_ahead_s = 0.0;
  /// Awake bodies that touch each other (a contact group) change rung together, all or none, by the distance
  /// of the nearest.
  bool contact_groups_together = false;

  ~PolicySettings();  // not inline: GCC 12 at -O3 warns of its functions in settings that do not name them
};

}  // namespace lodestone
