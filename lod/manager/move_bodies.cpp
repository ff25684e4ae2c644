#include "lod/manager/move_bodies.h"

#include <algorithm>

#include "lod/manager/crowded_places.h"
#include "lod/manager/transfer.h"
#include "lod/timing/stage_timer.h"

namespace lodestone {

void MoveBodies::count_down_retries() {
  for (const std::uint32_t body : levels_.put_off.count_down()) levels_.bodies.level(body).put_off = false;
}

void MoveBodies::bring_back_woken(Groups::Return how, StepReport& report) {
  std::vector<GroupId> woken;
  choose_.groups().wake_together(woken);
  for (const GroupId group : woken) {
    report.promotions += choose_.groups().bring_back(group, how);
    for (const std::uint32_t body : choose_.groups().members(group)) choose_.note(body);
  }
}

void MoveBodies::supply_signatures() {
  choose_.supply_waiting([this](std::uint32_t body) {
    const std::int64_t changed_at = levels_.bodies.level(body).changed_at;
    find_signature(levels_, body, Rung::support);
    transfer(levels_, body, Rung::support);
    levels_.bodies.level(body).changed_at = changed_at;
  });
}

void MoveBodies::run(const RungChanges& changes, StepReport& report) {
  const StageTimer timer(report.times.transfer_ms);
  const std::vector<std::uint32_t> held = find_held_back(levels_);
  report.counters.bodies_held_back += std::int64_t(held.size());
  const auto each_run = [](Run all, const auto& act) {
    for (std::size_t begin = 0, end; begin < all.size(); begin = end) {
      for (end = begin + 1;
           all[begin].together >= 0 && end < all.size() && all[end].together == all[begin].together;)
        ++end;
      act(all.subspan(begin, end - begin));
    }
  };
  each_run(changes.demote, [&](Run run) { demote(run, report); });
  each_run(changes.promote, [&](Run run) { promote(run, held, report); });
  BodyTable& bodies = levels_.bodies;
  for (std::size_t i = 0; i < bodies.newcomers().size(); ++i)
    if (bodies.waits_at(i) && !std::ranges::binary_search(held, bodies.newcomers()[i].index))
      place(levels_, bodies.newcomers()[i].index, bodies.newcomers()[i].rung);
  bodies.forget_newcomers();
  choose_.done();
}

void MoveBodies::demote(Run run, StepReport& report) {
  Groups& groups = choose_.groups();
  const bool on_joints =
      std::ranges::any_of(run, [&](const RungChanges::Change& change) { return groups.joined(change.body); });
  if (const GroupId group = groups.of(run.front().body); on_joints && group && !groups.release(group)) return;
  for (const RungChanges::Change& change : run) {
    const bool audited = audit_.on() && levels_.bodies[change.body].ode && !levels_.asleep(change.body);
    transfer(levels_, change.body, change.to);
    if (audited) audit_.watch(change.body, levels_.state(change.body));
    choose_.note(change.body);
    ++report.demotions;
  }
}

// One that overlaps a body of no matter which other run keeps all of its run where they are.
void MoveBodies::promote(Run run, std::span<const std::uint32_t> held, StepReport& report) {
  Groups& groups = choose_.groups();
  const GroupId group = groups.of(run.front().body);
  if (group && groups.detached(group) && run.front().to == Rung::full) {
    report.promotions += groups.bring_back(group, Groups::Return::asleep);
    return;
  }
  std::vector<std::uint32_t> bodies;
  for (const RungChanges::Change& change : run) bodies.push_back(change.body);
  const bool blocked = run.front().to == Rung::full && std::ranges::any_of(bodies, [&](std::uint32_t body) {
                         const BodyLevel& level = levels_.bodies.level(body);
                         const bool placed_full = level.newcomer && level.choice == LevelChoice::full;
                         return !placed_full && overlaps(levels_, body, bodies);
                       });
  for (const RungChanges::Change& change : run)
    if (!std::ranges::binary_search(held, change.body)) promote(change, blocked, report);
}

void MoveBodies::promote(const RungChanges::Change& change, bool blocked, StepReport& report) {
  const auto [body, wanted, open, together] = change;
  const BodyLevel& level = levels_.bodies.level(body);
  // Spheres overlap where hulls do not yet: `support` parts them.
  const bool may_wait_at_support = open.has(Rung::support) || level.choice == LevelChoice::full;
  const Rung to = blocked && !level.newcomer && level.rung == Rung::tables && may_wait_at_support
                      ? Rung::support
                      : wanted;
  if (blocked && to == Rung::full) {
    put_off(body, report);
  } else if (level.newcomer) {
    place(levels_, body, to);
  } else {
    transfer(levels_, body, to);
    if (to != wanted) levels_.bodies.level(body).reason = Rule::overlap_put_off;
    if (to == Rung::full)
      levels_.put_off.forget(body);
    else
      choose_.note(body);
    ++report.promotions;
  }
}

void MoveBodies::put_off(std::uint32_t body, StepReport& report) {
  levels_.put_off.put_off(body);
  levels_.bodies.level(body).put_off = true;
  levels_.bodies.level(body).reason = Rule::overlap_put_off;
  choose_.note(body);
  ++report.counters.promotions_put_off;
}

}  // namespace lodestone
