// Stage 1 of a step: which levels the policy wants. It is asked about those bodies alone for which its answer may have changed: those that are full, awake, new,
// put off or changed by the caller, and of those that sleep the ones whose turn it is (far_bodies.h). The others keep the level and the reason that they have, and the
// decision is the one that it would be of all.
#include <algorithm>
#include <cmath>
#include <utility>

#include "lod/manager_impl.h"
#include "lod/stage_timer.h"

namespace lodestone {
namespace {

// m of travel, and over the distance: by so much a body's turn comes early, for rounding.
constexpr double kEarly = 1e-6;

}  // namespace

std::optional<LevelDecision> Manager::Impl::choose() {
  const StageTimer timer(report.times.choose_ms);
  count_down_retries();
  look_at_those_concerned();
  if (const auto* budget = std::get_if<BudgetPolicy>(&policy.policy); budget && !viewpoints.empty()) look_at_nearest(*budget);
  if (asked.empty()) {
    look_at_all = false;
    return {};
  }
  put_in_order();
  LevelDecision decision = choose_levels(candidates, viewpoints, policy, full_body_step_ms, statistical_ms);
  take_answers(decision);
  return decision;
}

void Manager::Impl::look_at_those_concerned() {
  asked.clear();
  candidates.clear();
  BodyTable& bodies = levels.bodies;
  std::vector<std::uint32_t> some = std::move(wishing);
  some.insert(some.end(), changed.begin(), changed.end());
  wishing.clear(), changed.clear();
  const bool all = std::exchange(look_at_all, true);  // until the step has done what was decided
  if (all) {
    far.clear();
    for (std::uint32_t body = 0; body < bodies.indices(); ++body) look_at(body);
    return;
  }
  if (std::holds_alternative<DistancePolicy>(policy.policy))  // before any are put in again
    while (far.next_due() <= traveled) far.take_next(some);
  for (const FullLevel::Member& member : levels.full.members()) look_at(member.owner);
  for (const BodyTable::Newcomer& newcomer : bodies.newcomers()) look_at(newcomer.index);
  if (levels.statistical && policy_sees_places()) {
    for (const std::int32_t slot : levels.statistical->awake()) look_at(levels.owner_of_slot[std::size_t(slot)]);
    for (const std::uint32_t body : fell_asleep) look_at(body);
  }
  for (const std::uint32_t body : some) look_at(body);
}

// Of the sleepers the nearest as well, until as many are known as may become full.
void Manager::Impl::look_at_nearest(const BudgetPolicy& budget) {
  const std::int64_t wanted = count_wanted(candidates, budget, policy.hysteresis, full_body_step_ms, statistical_ms);
  if (wanted == 0) return;
  std::vector<double> distances;
  std::vector<std::uint32_t> next;
  for (std::size_t known = 0; ; next.clear()) {
    for (; known < candidates.size(); ++known)
      if (!candidates[known].decided()) distances.push_back(rank_distance(candidates[known], viewpoints, policy.hysteresis));
    const double least = (far.next_due() - traveled) / levels.bodies.greatest_importance();  // of those that are left
    if (std::int64_t(distances.size()) >= wanted) {
      std::ranges::nth_element(distances, distances.begin() + std::ptrdiff_t(wanted - 1));
      if (distances[std::size_t(wanted - 1)] < least) return;
    }
    far.take_next(next);
    if (next.empty() && far.next_due() > 1e299) return;
    for (const std::uint32_t body : next) look_at(body);
  }
}

void Manager::Impl::look_at(std::uint32_t body) {
  if (!levels.bodies.alive(body)) return;
  BodyLevel& level = levels.bodies.level(body);
  if (level.looked_at == report.step) return;
  level.looked_at = report.step;
  ++report.counters.levels_considered;
  if (level.level == Level::full || level.newcomer) note_waiting(body);
  if (level.choice == LevelChoice::statistical && level.level == Level::statistical && !level.newcomer && !level.waits_for_signature) {
    level.reason = LevelReason::forced;
    return;
  }
  const LevelCandidate candidate = make_candidate(body);
  const auto* distance = std::get_if<DistancePolicy>(&policy.policy);
  if (distance && !level.newcomer && stays_far(candidate, viewpoints, distance->full_within)) {
    level.reason = LevelReason::far;
    put_far(body, candidate);
    return;
  }
  asked.push_back(body);
  candidates.push_back(candidate);
}

LevelCandidate Manager::Impl::make_candidate(std::uint32_t body) const {
  const BodyLevel& level = levels.bodies.level(body);
  const BodyRecord& record = levels.bodies[body];
  const double radius = levels.bodies.shape(body)->radius;
  LevelCandidate candidate{.position = {},
                           .radius = radius,
                           .importance = level.importance,
                           .choice = level.choice,
                           .level = level.level,
                           .waits_for_signature = level.waits_for_signature,
                           .newcomer = level.newcomer,
                           .put_off = level.put_off};
  candidate.frames_since_change = std::int32_t(std::min<std::int64_t>(report.step - level.changed_at, LevelCandidate{}.frames_since_change));
  if (static_bounds.empty() && record.slot >= 0) {
    candidate.position = levels.statistical->position(record.slot);  // all that it takes, of most bodies
  } else {
    const RigidState state = levels.state(body);
    candidate.position = state.position;
    candidate.on_static_ground = near_static_ground(state, radius);
  }
  return candidate;
}

// A sleeper: where it is, and how far the viewpoints can travel before that matters.
void Manager::Impl::put_far(std::uint32_t body, const LevelCandidate& candidate) {
  const BodyRecord& record = levels.bodies[body];
  if (viewpoints.empty() || record.slot < 0 || !levels.statistical->asleep(record.slot)) return;
  double nearest = 1e300;
  for (const Vec3& viewpoint : viewpoints) nearest = std::min(nearest, (candidate.position - viewpoint).norm());
  const auto* distance = std::get_if<DistancePolicy>(&policy.policy);
  const double within = candidate.radius + (distance ? distance->full_within * candidate.importance : 0.0);
  far.put(body, traveled + nearest - within - kEarly * (1.0 + nearest));
}

// By index, on which the policy falls back among equals.
void Manager::Impl::put_in_order() {
  if (std::ranges::is_sorted(asked)) return;
  std::vector<std::uint32_t> order(asked.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::sort(order, {}, [this](std::uint32_t i) { return asked[i]; });
  std::vector<LevelCandidate> ordered(candidates.size());
  for (std::size_t i = 0; i < order.size(); ++i) ordered[i] = candidates[order[i]];
  candidates = std::move(ordered);
  std::ranges::sort(asked);
}

void Manager::Impl::take_answers(LevelDecision& decision) {
  for (std::size_t i = 0; i < asked.size(); ++i) {
    const std::uint32_t body = asked[i];
    const LevelReason reason = decision.reasons[i];
    levels.bodies.level(body).reason = reason;
    if (reason == LevelReason::dwell || reason == LevelReason::queued || reason == LevelReason::overlap_put_off) wishing.push_back(body);
    else if (reason == LevelReason::far || reason == LevelReason::over_budget) put_far(body, candidates[i]);
  }
  for (auto* changes : {&decision.promote, &decision.demote})
    for (std::int32_t& body : *changes) body = std::int32_t(asked[std::size_t(body)]);
}

void Manager::Impl::note_waiting(std::uint32_t body) {
  BodyLevel& level = levels.bodies.level(body);
  const MaterialId material = levels.bodies[body].material;
  level.waits_for_signature = level.choice != LevelChoice::full && !levels.signatures.ready(*levels.bodies.shape(body), levels.ground_law(material));
}

// Near enough to be there within three frames of a game. The support model meets static boxes and meshes by itself.
bool Manager::Impl::near_static_ground(const RigidState& state, double radius) const {
  if (levels.statistical_settings.model == StatisticalModel::support) return false;
  const double reach = 1.5 * radius + 0.05 * state.velocity.norm();
  return std::ranges::any_of(static_bounds, [&](const Eigen::AlignedBox3d& box) { return box.exteriorDistance(state.position) < reach; });
}

}  // namespace lodestone
