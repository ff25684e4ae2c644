// The stages of a step, in order.
#include <algorithm>
#include <utility>

#include "lod/manager_impl.h"
#include "lod/stage_timer.h"
#include "lod/transfer.h"
#include "reference/ode/static_planes.h"

namespace lodestone {
namespace {

// A promotion that was put off is tried again after 8 frames, then 16, … 128: overlapping bodies must not use up every frame's changes.
constexpr int kFirstRetry = 8, kLastRetry = 128;
// Weight of the newest measurement in a smoothed cost.
constexpr double kNewest = 0.1;

void smooth(double& value, double newest) { value += kNewest * (newest - value); }

}  // namespace

const StepReport& Manager::Impl::step(double dt) {
  begin_report();
  {
    const StageTimer timer(report.times.total_ms);
    // 1 choose levels
    std::optional<LevelDecision> decision = choose();
    // 2 transfer
    move_bodies(std::move(decision));
    // 3 statistical level and its contacts with full bodies
    step_statistical(dt);
    // 4 full level
    step_full(dt);
  }
  // 5 report
  finish_report();
  return report;
}

void Manager::Impl::begin_report() { report = {.step = report.step + 1, .times = {}, .counters = report.counters}; }

// Nothing may have changed that the policy looks at: full bodies move, newcomers and those put off wait for a level.
bool Manager::Impl::may_leave_unasked() const {
  return settled && (all_still || !positions_matter) && newcomers.empty() && put_off.empty() && levels.full.members().empty() && static_bounds.empty();
}

std::optional<LevelDecision> Manager::Impl::choose() {
  const StageTimer timer(report.times.choose_ms);
  if (may_leave_unasked()) {
    ++frames_unasked;
    return {};
  }
  count_down_retries();
  if (!viewpoints.empty()) see_statistical();
  std::vector<LevelCandidate>& candidates = levels.bodies.candidates();
  for (const FullLevel::Member& member : levels.full.members()) see(member.owner, levels.full.world()->state(member.id)), note_waiting(member.owner);
  for (const std::uint32_t body : newcomers) see(body, levels.bodies[body].definition.state), note_waiting(body);
  const int frames = 1 + std::exchange(frames_unasked, 0);
  for (LevelCandidate& candidate : candidates)
    candidate.frames_since_change = std::min(candidate.frames_since_change + frames, LevelCandidate{}.frames_since_change);
  LevelDecision decision = choose_levels(candidates, viewpoints, policy, full_body_step_ms, statistical_ms);
  settled = decision.settled;
  positions_matter = decision.positions_matter;
  return decision;
}

void Manager::Impl::see(std::uint32_t body, const RigidState& state) {
  LevelCandidate& candidate = levels.bodies.candidates()[body];
  candidate.position = state.position;
  candidate.on_static_ground = near_static_ground(state, candidate.radius);
}

void Manager::Impl::note_waiting(std::uint32_t body) {
  LevelCandidate& candidate = levels.bodies.candidates()[body];
  const BodyDefinition& definition = levels.bodies[body].definition;
  candidate.waits_for_signature =
      candidate.choice != LevelChoice::full && !levels.signatures.ready(*definition.shape, levels.ground_law(definition.material));
}

// Near enough to be there within three frames of a game. The support model meets static boxes and meshes by itself.
bool Manager::Impl::near_static_ground(const RigidState& state, double radius) const {
  if (levels.statistical_settings.model == StatisticalModel::support) return false;
  const double reach = 1.5 * radius + 0.05 * state.velocity.norm();
  return std::ranges::any_of(static_bounds, [&](const Eigen::AlignedBox3d& box) { return box.exteriorDistance(state.position) < reach; });
}

void Manager::Impl::move_bodies(std::optional<LevelDecision> decision) {
  const StageTimer timer(report.times.transfer_ms);
  read_callers_planes();
  levels.ground.solids.prepare();
  if (!decision) return;
  reasons = std::move(decision->reasons);
  if (!decision->demote.empty() || !decision->promote.empty()) see_statistical();
  for (const std::int32_t body : decision->demote) {
    transfer(levels, body);
    ++report.demotions;
  }
  for (const std::int32_t body : decision->promote) promote(body);
  for (const std::uint32_t body : newcomers)
    if (levels.bodies.candidates()[body].newcomer) place(levels, body, Level::statistical);
  newcomers.clear();
}

void Manager::Impl::promote(std::uint32_t body) {
  const LevelCandidate& candidate = levels.bodies.candidates()[body];
  const bool placed_full = candidate.newcomer && (candidate.choice == LevelChoice::full || candidate.waits_for_signature);
  if (!placed_full && overlaps(levels, body)) {
    put_promotion_off(body);
  } else if (candidate.newcomer) {
    place(levels, body, Level::full);
  } else {
    transfer(levels, body);
    levels.bodies[body].retry_after = 0;
    ++report.promotions;
  }
}

void Manager::Impl::put_promotion_off(std::uint32_t body) {
  BodyRecord& record = levels.bodies[body];
  record.frames_to_retry = record.retry_after = std::clamp(2 * record.retry_after, kFirstRetry, kLastRetry);
  levels.bodies.candidates()[body].put_off = true;
  put_off.push_back(body);
  reasons[body] = LevelReason::overlap_put_off;
  ++report.counters.promotions_put_off;
}

void Manager::Impl::count_down_retries() {
  std::erase_if(put_off, [this](std::uint32_t body) {
    if (--levels.bodies[body].frames_to_retry > 0) return false;
    levels.bodies.candidates()[body].put_off = false;
    return true;
  });
}

void Manager::Impl::step_statistical(double dt) {
  all_still = true;
  if (levels.owner_of_slot.empty()) {
    give_forces();
    statistical_ms = 0.0;
    return;
  }
  {
    const StageTimer timer(report.times.cross_level_ms);
    gather(levels, neighborhood);
    give_forces();
  }
  const bool follow = positions_matter || !static_bounds.empty();
  const auto was_awake = levels.statistical->awake();
  all_still = was_awake.empty();
  if (follow) moved.assign(was_awake.begin(), was_awake.end());
  levels.statistical->step(dt, neighborhood.bodies, report, neighborhood.contacts);
  all_still &= levels.statistical->awake().empty();
  if (follow) follow_moved();
  else positions_old |= !all_still;
  {
    const StageTimer timer(report.times.cross_level_ms);
    hand_over(levels, neighborhood, dt);
  }
  const StageTimes& t = report.times;
  smooth(statistical_ms, t.flight_ms + t.broad_phase_ms + t.pairs_ms + t.crowd_ms + t.rest_ms + t.cross_level_ms);
}

// Those that slept through the step have not moved, and cost nothing here.
void Manager::Impl::follow_moved() {
  const StageTimer timer(report.times.choose_ms);
  const StatisticalLevel& level = *levels.statistical;
  const auto look = [&](std::int32_t slot) {
    const std::uint32_t body = levels.owner_of_slot[slot];
    if (static_bounds.empty()) levels.bodies.candidates()[body].position = level.position(slot);  // all that the policy needs
    else see(body, level.state(slot));
  };
  for (const std::int32_t slot : level.awake()) look(slot);
  for (const std::int32_t slot : moved)
    if (level.asleep(slot)) look(slot);
}

void Manager::Impl::see_statistical() {
  if (!std::exchange(positions_old, false)) return;
  for (std::size_t slot = 0; slot < levels.owner_of_slot.size(); ++slot)
    levels.bodies.candidates()[levels.owner_of_slot[slot]].position = levels.statistical->position(int(slot));
}

void Manager::Impl::step_full(double dt) {
  {
    const StageTimer timer(report.times.full_ms);
    levels.full.step(dt, report.counters);
  }
  const auto bodies = levels.full.members().size();
  if (bodies > 0) smooth(full_body_step_ms, report.times.full_ms / double(bodies));
}

void Manager::Impl::finish_report() {
  report.full = int(levels.full.members().size());
  report.statistical = int(levels.owner_of_slot.size());
  report.asleep = levels.full.asleep_count() + (levels.statistical ? levels.statistical->asleep_count() : 0);
  report.counters.signatures_loaded = levels.signatures.loaded();
}

void Manager::Impl::give_forces() {
  for (const std::uint32_t body : pushed)
    if (levels.bodies.alive(body)) levels.give_force(body);
  pushed.clear();
}

void Manager::Impl::read_callers_planes() {
  if (!callers_space) return;
  std::vector<HalfSpace>& planes = levels.ground.planes;
  planes.resize(own_planes);
  for (const StaticPlane& plane : find_static_planes(callers_space)) planes.push_back({plane.normal, plane.offset, 0});
}

}  // namespace lodestone
