#include "lod/manager/move_bodies.h"

#include <algorithm>

#include "lod/manager/transfer.h"
#include "lod/timing/stage_timer.h"

namespace lodestone {
namespace {

// A promotion that was put off is tried again after 8 frames, then 16, … 128: overlapping bodies must not use up every frame's changes.
constexpr int kFirstRetry = 8, kLastRetry = 128;

}  // namespace

void MoveBodies::count_down_retries() {
  std::erase_if(put_off_, [this](std::uint32_t body) {
    if (--levels_.bodies.rare(body).frames_to_retry > 0) return false;
    levels_.bodies.level(body).put_off = false;
    return true;
  });
}

void MoveBodies::run(const RungChanges& changes, StepReport& report) {
  const StageTimer timer(report.times.transfer_ms);
  for (const RungChanges::Change& change : changes.demote) {
    transfer(levels_, change.body, change.to);
    choose_.note(change.body);
    ++report.demotions;
  }
  for (const RungChanges::Change& change : changes.promote) promote(change, report);
  BodyTable& bodies = levels_.bodies;
  for (std::size_t i = 0; i < bodies.newcomers().size(); ++i)
    if (bodies.waits_at(i)) place(levels_, bodies.newcomers()[i].index, bodies.newcomers()[i].rung);
  bodies.forget_newcomers();
  choose_.done();
}

void MoveBodies::promote(const RungChanges::Change& change, StepReport& report) {
  const auto [body, wanted, open] = change;
  const BodyLevel& level = levels_.bodies.level(body);
  const bool placed_full = level.newcomer && (level.choice == LevelChoice::full || level.waits_for_signature);
  const bool blocked = wanted == Rung::full && !placed_full && overlaps(levels_, body);
  // Spheres overlap where hulls do not yet: `support` parts them.
  const Rung to = blocked && !level.newcomer && level.rung == Rung::tables && open.has(Rung::support) ? Rung::support : wanted;
  if (blocked && to == Rung::full) {
    put_off(body, report);
  } else if (level.newcomer) {
    place(levels_, body, to);
  } else {
    transfer(levels_, body, to);
    if (to == Rung::full) levels_.bodies.forget_retries(body);
    else choose_.note(body);
    ++report.promotions;
  }
}

void MoveBodies::put_off(std::uint32_t body, StepReport& report) {
  BodyTable::Rare& rare = levels_.bodies.rare(body);
  rare.frames_to_retry = rare.retry_after = std::clamp(2 * rare.retry_after, kFirstRetry, kLastRetry);
  levels_.bodies.level(body).put_off = true;
  levels_.bodies.level(body).reason = LevelReason::overlap_put_off;
  put_off_.push_back(body);
  choose_.note(body);
  ++report.counters.promotions_put_off;
}

}  // namespace lodestone
