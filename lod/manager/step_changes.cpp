#include "lod/manager/step_changes.h"

#include <algorithm>

namespace lodestone {

void StepChanges::begin() {
  rung_changes_.clear();
  fell_asleep_.clear();
  woke_.clear();
  moved_.clear();
  moved_and_slept_.clear();
  settled_.clear();
  moved_known_ = true;
}

void StepChanges::add(std::uint32_t body) {
  if (slept_.size() <= body) slept_.resize(std::size_t(body) + 1, 0);
  slept_[body] = levels_.asleep(body);
  lies_at_.resize(slept_.size(), Vec3::Zero());
}

// Where one lies that comes to the full level asleep was not known there.
void StepChanges::note_promoted() {
  for (; noted_changes_ < levels_.rung_changes.size(); ++noted_changes_)
    if (const RungChange& change = levels_.rung_changes[noted_changes_];
        change.to == Rung::full && levels_.bodies.valid(change.body))
      lies_at_[change.body.index] = levels_.state(change.body.index).position;
}

void StepChanges::take_part() {
  noted_.insert(noted_.end(), levels_.woken.begin(), levels_.woken.end());
  levels_.woken.clear();
  if (!levels_.statistical) return;
  levels_.statistical->take_woke(noted_);
  for (const std::uint32_t body : levels_.statistical->fell_asleep()) settled_.push_back(body);
}

void StepChanges::finish() {
  for (const FullLevel::Member& member : levels_.full.members()) {
    noted_.push_back(member.owner);
    const Vec3 at = levels_.state(member.owner).position;
    if (at != lies_at_[member.owner]) settled_.push_back(member.owner);
    lies_at_[member.owner] = at;
  }
  noted_.insert(noted_.end(), settled_.begin(), settled_.end());
  // One that left the full level asleep may have been woken on its new rung.
  for (const RungChange& change : levels_.rung_changes) noted_.push_back(change.body.index);
  std::ranges::sort(noted_);
  noted_.erase(std::unique(noted_.begin(), noted_.end()), noted_.end());
  std::ranges::sort(settled_);
  for (const std::uint32_t body : noted_) {
    if (!levels_.bodies.alive(body)) continue;
    const bool before = slept_[body], now = levels_.asleep(body);
    if (now && !before)
      fell_asleep_.push_back(levels_.bodies.id(body));
    else if (before && !now)
      woke_.push_back(levels_.bodies.id(body));
    else if (now && std::ranges::binary_search(settled_, body))
      moved_and_slept_.push_back(levels_.bodies.id(body));
    slept_[body] = now;
  }
  noted_.clear();
  std::swap(rung_changes_, levels_.rung_changes);
  levels_.rung_changes.clear();
  noted_changes_ = 0;
  moved_known_ = false;
}

std::span<const BodyId> StepChanges::moved() const {
  const std::lock_guard lock(access_);
  if (!moved_known_) find_moved();
  moved_known_ = true;
  return moved_;
}

void StepChanges::find_moved() const {
  moved_.clear();
  for (const FullLevel::Member& member : levels_.full.members())
    if (!levels_.full.world()->asleep(member.id)) moved_.push_back(levels_.bodies.id(member.owner));
  std::vector<std::uint32_t> awake;
  if (levels_.statistical) levels_.statistical->find_awake(awake);
  for (const std::uint32_t body : awake) moved_.push_back(levels_.bodies.id(body));
  moved_.insert(moved_.end(), fell_asleep_.begin(), fell_asleep_.end());
  moved_.insert(moved_.end(), moved_and_slept_.begin(), moved_and_slept_.end());
}

}  // namespace lodestone
