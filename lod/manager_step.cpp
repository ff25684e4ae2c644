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

void Manager::Impl::begin_report() {
  report = {.step = report.step + 1, .times = {}, .counters = report.counters};
  levels.now = report.step;
}

void Manager::Impl::move_bodies(std::optional<LevelDecision> decision) {
  const StageTimer timer(report.times.transfer_ms);
  read_callers_planes();
  levels.ground.solids.prepare();
  if (!decision) return;
  for (const std::int32_t body : decision->demote) {
    transfer(levels, std::uint32_t(body));
    changed.push_back(std::uint32_t(body));
    ++report.demotions;
  }
  for (const std::int32_t body : decision->promote) promote(std::uint32_t(body));
  BodyTable& bodies = levels.bodies;
  for (std::size_t i = 0; i < bodies.newcomers().size(); ++i)
    if (bodies.is_newcomer_at(i)) place(levels, bodies.newcomers()[i].index, Level::statistical);
  bodies.forget_newcomers();
  look_at_all = false;
}

void Manager::Impl::promote(std::uint32_t body) {
  const BodyLevel& level = levels.bodies.level(body);
  const bool placed_full = level.newcomer && (level.choice == LevelChoice::full || level.waits_for_signature);
  if (!placed_full && overlaps(levels, body)) {
    put_promotion_off(body);
  } else if (level.newcomer) {
    place(levels, body, Level::full);
  } else {
    transfer(levels, body);
    levels.bodies.forget_retries(body);
    ++report.promotions;
  }
}

void Manager::Impl::put_promotion_off(std::uint32_t body) {
  BodyTable::Rare& rare = levels.bodies.rare(body);
  rare.frames_to_retry = rare.retry_after = std::clamp(2 * rare.retry_after, kFirstRetry, kLastRetry);
  levels.bodies.level(body).put_off = true;
  levels.bodies.level(body).reason = LevelReason::overlap_put_off;
  put_off.push_back(body);
  wishing.push_back(body);
  ++report.counters.promotions_put_off;
}

void Manager::Impl::count_down_retries() {
  std::erase_if(put_off, [this](std::uint32_t body) {
    if (--levels.bodies.rare(body).frames_to_retry > 0) return false;
    levels.bodies.level(body).put_off = false;
    return true;
  });
}

void Manager::Impl::step_statistical(double dt) {
  if (levels.owner_of_slot.empty()) {
    levels.give_forces();
    statistical_ms = 0.0;
    return;
  }
  {
    const StageTimer timer(report.times.cross_level_ms);
    gather(levels, neighborhood);
    levels.give_forces();
  }
  were_awake.clear();
  if (policy_sees_places()) were_awake.assign(levels.statistical->awake().begin(), levels.statistical->awake().end());
  levels.statistical->step(dt, neighborhood.bodies, report, neighborhood.contacts);
  fell_asleep.clear();
  for (const std::int32_t slot : were_awake)
    if (levels.statistical->asleep(slot)) fell_asleep.push_back(levels.owner_of_slot[std::size_t(slot)]);
  {
    const StageTimer timer(report.times.cross_level_ms);
    hand_over(levels, neighborhood, dt);
  }
  const StageTimes& t = report.times;
  smooth(statistical_ms, t.flight_ms + t.broad_phase_ms + t.pairs_ms + t.crowd_ms + t.rest_ms + t.cross_level_ms);
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

void Manager::Impl::read_callers_planes() {
  if (!callers_space) return;
  std::vector<HalfSpace>& planes = levels.ground.planes;
  planes.resize(own_planes);
  for (const StaticPlane& plane : find_static_planes(callers_space)) planes.push_back({plane.normal, plane.offset, 0});
}

}  // namespace lodestone
