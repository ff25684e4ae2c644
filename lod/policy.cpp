// Each policy says what level it wants for every body; what dwell, queue and cap then allow is the same for all.
#include "lod/policy.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lodestone {
namespace {

/// What the policy itself wants of one body.
struct Target {
  Level level = Level::statistical;
  LevelReason reason = LevelReason::far;
  bool at_once = false;  // neither dwell nor cap may hold it up
};

/// A body by its distance, or by its rank among the others; ties go to the lower index, so that the order is the same in every run.
struct Ranked {
  double distance = 0.0;
  std::int32_t index = 0;
};
bool nearer(const Ranked& a, const Ranked& b) {
  return a.distance != b.distance ? a.distance < b.distance : a.index < b.index;
}
bool farther(const Ranked& a, const Ranked& b) {
  return a.distance != b.distance ? a.distance > b.distance : a.index < b.index;
}

double squared_distance(const LevelCandidate& candidate, std::span<const Vec3> viewpoints) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Vec3& viewpoint : viewpoints) nearest = std::min(nearest, (candidate.position - viewpoint).squaredNorm());
  return nearest;
}

double scaled_distance(const LevelCandidate& candidate, std::span<const Vec3> viewpoints) {
  return std::max(0.0, std::sqrt(squared_distance(candidate, viewpoints)) - candidate.radius) / candidate.importance;
}

Target target_by_distance(const LevelCandidate& candidate, double distance, double full_within, double hysteresis) {
  if (distance <= full_within) return {Level::full, LevelReason::near};
  if (candidate.level == Level::full && distance <= full_within * (1.0 + hysteresis))
    return {Level::full, LevelReason::within_hysteresis};
  return {Level::statistical, LevelReason::far};
}

LevelReason reason_to_have_decided(const LevelCandidate& c) {
  if (c.choice == LevelChoice::full) return LevelReason::forced;
  if (c.waits_for_signature) return LevelReason::signature_pending;
  return c.choice == LevelChoice::automatic ? LevelReason::static_ground : LevelReason::forced;
}

/// How many bodies of this cost fit the milliseconds.
std::int64_t count_that_fit(double milliseconds, double full_body_step_ms) {
  return std::int64_t(std::clamp(milliseconds / std::max(full_body_step_ms, 1e-9), 0.0, 1e9));
}

/// Automatic bodies that a budget has room for.
struct BudgetRoom {
  std::int64_t full = 0;    // that are full
  std::int64_t most = 0;
  std::int64_t wanted = 0;
};

// The number of full bodies grows while part of the budget is free, and shrinks when all of it is used up.
BudgetRoom find_room(std::span<const LevelCandidate> candidates, const BudgetPolicy& policy, double hysteresis, double full_body_step_ms, double statistical_ms) {
  BudgetRoom room;
  std::int64_t forced = 0;
  for (const LevelCandidate& c : candidates) {
    if (c.must_be_full()) ++forced;
    else if (!c.decided() && c.level == Level::full) ++room.full;
  }
  const double left_ms = policy.budget_ms - statistical_ms;
  room.most = std::max<std::int64_t>(0, count_that_fit(left_ms, full_body_step_ms) - forced);
  const std::int64_t grow_to = count_that_fit(left_ms / (1.0 + hysteresis), full_body_step_ms) - forced;
  room.wanted = std::min(room.most, std::max(room.full, grow_to));
  return room;
}

class Chooser {
 public:
  Chooser(std::span<const LevelCandidate> candidates, std::span<const Vec3> viewpoints, const PolicySettings& settings)
      : candidates_(candidates), viewpoints_(viewpoints), settings_(settings) {
    decision_.reasons.resize(candidates.size());
  }

  LevelDecision by(const DistancePolicy& policy) {
    for (std::int32_t i = 0; i < count(); ++i) {
      if (stays_far(candidates_[i], viewpoints_, policy.full_within)) {
        decision_.reasons[i] = LevelReason::far;
        continue;
      }
      const double distance = scaled_distance(candidates_[i], viewpoints_);
      consider({distance, i}, target_by_distance(candidates_[i], distance, policy.full_within, settings_.hysteresis));
    }
    grant(std::numeric_limits<std::int64_t>::max());
    return std::move(decision_);
  }

  LevelDecision by(const BudgetPolicy& policy, double full_body_step_ms, double statistical_ms) {
    const BudgetRoom room = find_room(candidates_, policy, settings_.hysteresis, full_body_step_ms, statistical_ms);
    const std::vector<Ranked> ranked = rank(room.wanted);
    for (std::int64_t place = 0; place < std::int64_t(ranked.size()); ++place)
      consider(ranked[place], target_by_rank(place < room.wanted, room.full > room.most));
    for (std::int32_t i = 0; i < count(); ++i)
      if (candidates_[i].decided()) consider({0.0, i}, {});
    grant(room.wanted - room.full);
    return std::move(decision_);
  }

 private:
  std::int32_t count() const { return std::int32_t(candidates_.size()); }

  /// The automatic bodies, the `wanted` nearest of them before the rest; full ones count as nearer by the hysteresis.
  std::vector<Ranked> rank(std::int64_t wanted) const {
    std::vector<Ranked> ranked;
    for (std::int32_t i = 0; i < count(); ++i) {
      const LevelCandidate& c = candidates_[i];
      if (c.decided()) continue;
      ranked.push_back({rank_distance(c, viewpoints_, settings_.hysteresis), i});
    }
    std::ranges::nth_element(ranked, ranked.begin() + std::min(wanted, std::int64_t(ranked.size())), nearer);
    return ranked;
  }

  Target target_by_rank(bool wanted, bool over_budget) const {
    if (viewpoints_.empty()) return {Level::statistical, LevelReason::far};
    if (wanted) return {Level::full, LevelReason::in_budget};
    return {Level::statistical, LevelReason::over_budget, over_budget};
  }

  /// Notes why body `by_distance.index` has its level, and its wish for a change.
  void consider(const Ranked& by_distance, Target target) {
    const LevelCandidate& c = candidates_[by_distance.index];
    LevelReason& reason = decision_.reasons[by_distance.index];
    const bool forced = c.decided();
    if (forced)
      target = {c.must_be_full() ? Level::full : Level::statistical, reason_to_have_decided(c), true};
    reason = target.reason;
    if (target.level == c.level) return;

    const bool up = target.level == Level::full;
    if (up && c.put_off && !c.newcomer) {
      reason = LevelReason::overlap_put_off;
    } else if (forced) {
      (up ? decision_.promote : decision_.demote).push_back(by_distance.index);
    } else if (target.at_once || c.newcomer) {
      (up ? promote_at_once_ : demote_at_once_).push_back(by_distance);
    } else if (c.frames_since_change < settings_.min_dwell_frames) {
      reason = LevelReason::dwell;
    } else {
      (up ? promote_ : demote_).push_back(by_distance);
    }
  }

  /// Lets wishes come true, `room` more full bodies at most and no more changes than the cap; the rest are queued.
  void grant(std::int64_t room) {
    std::ranges::sort(promote_at_once_, nearer);
    std::ranges::sort(demote_at_once_, farther);
    std::ranges::sort(promote_, nearer);
    std::ranges::sort(demote_, farther);
    for (const Ranked& wish : demote_at_once_) grant_demotion(wish, room);
    for (const Ranked& wish : promote_at_once_)
      if (room > 0) grant_promotion(wish, room);
      else decision_.reasons[wish.index] = LevelReason::over_budget;

    std::size_t up = 0, down = 0;
    for (int left = settings_.max_transitions_per_frame; left > 0; --left) {
      const bool can_rise = up < promote_.size() && room > 0, can_fall = down < demote_.size();
      if (can_rise && (up <= down || !can_fall)) grant_promotion(promote_[up++], room);
      else if (can_fall) grant_demotion(demote_[down++], room);
      else break;
    }
    for (; up < promote_.size(); ++up) decision_.reasons[promote_[up].index] = LevelReason::queued;
    for (; down < demote_.size(); ++down) decision_.reasons[demote_[down].index] = LevelReason::queued;
  }

  void grant_promotion(const Ranked& wish, std::int64_t& room) {
    decision_.promote.push_back(wish.index);
    --room;
  }
  void grant_demotion(const Ranked& wish, std::int64_t& room) {
    decision_.demote.push_back(wish.index);
    if (room < std::numeric_limits<std::int64_t>::max()) ++room;
  }

  std::span<const LevelCandidate> candidates_;
  std::span<const Vec3> viewpoints_;
  const PolicySettings& settings_;
  LevelDecision decision_;
  std::vector<Ranked> promote_at_once_, demote_at_once_, promote_, demote_;
};

}  // namespace

std::string_view text_of(LevelReason reason) {
  switch (reason) {
    case LevelReason::forced: return "the caller chose this level";
    case LevelReason::near: return "near a viewpoint";
    case LevelReason::far: return "far from every viewpoint";
    case LevelReason::within_hysteresis: return "only just past the limit, within the hysteresis";
    case LevelReason::dwell: return "it changed too recently to change again";
    case LevelReason::queued: return "it waits its turn: this step has made all the changes it may";
    case LevelReason::over_budget: return "nearer bodies use up the budget";
    case LevelReason::in_budget: return "among the nearest bodies that fit the budget";
    case LevelReason::overlap_put_off: return "its promotion waits until it overlaps no other body";
    case LevelReason::static_ground: return "near static boxes or meshes, which the tables model does not meet";
    case LevelReason::signature_pending: return "its signature is still being measured";
    case LevelReason::contact_group: return "it goes with the bodies that it touches";
  }
  return "";
}

// Told without a division.
bool stays_far(const LevelCandidate& c, std::span<const Vec3> viewpoints, double full_within) {
  const double reach = full_within * c.importance + c.radius;
  return c.level == Level::statistical && !c.decided() && squared_distance(c, viewpoints) > 1.001 * reach * reach;
}

double rank_distance(const LevelCandidate& c, std::span<const Vec3> viewpoints, double hysteresis) {
  const double distance = scaled_distance(c, viewpoints);
  return c.level == Level::full ? distance / (1.0 + hysteresis) : distance;
}

std::int64_t count_wanted(std::span<const LevelCandidate> candidates, const BudgetPolicy& policy, double hysteresis, double full_body_step_ms,
                          double statistical_ms) {
  return find_room(candidates, policy, hysteresis, full_body_step_ms, statistical_ms).wanted;
}

LevelDecision choose_levels(std::span<const LevelCandidate> candidates, std::span<const Vec3> viewpoints,
                            const PolicySettings& settings, double full_body_step_ms, double statistical_ms) {
  Chooser chooser(candidates, viewpoints, settings);
  if (const auto* distance = std::get_if<DistancePolicy>(&settings.policy)) return chooser.by(*distance);
  return chooser.by(std::get<BudgetPolicy>(settings.policy), full_body_step_ms, statistical_ms);
}

}  // namespace lodestone
