#include "lod/manager/groups.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "lod/manager/transfer.h"
#include "reference/error.h"
#include "reference/ode/body_joints.h"

namespace lodestone {

GroupId Groups::make(std::span<const std::uint32_t> bodies, GroupJoints joints) {
  std::vector<std::uint32_t> members(bodies.begin(), bodies.end());
  std::ranges::sort(members);
  const bool twice = std::ranges::adjacent_find(members) != members.end();
  if (members.empty() || twice ||
      std::ranges::any_of(members, [&](std::uint32_t body) { return group_of_.contains(body); }))
    return {};
  std::size_t index = groups_.size();
  if (free_.empty()) {
    groups_.emplace_back();
  } else {
    std::ranges::pop_heap(free_, std::ranges::greater{});
    index = free_.back();
    free_.pop_back();
  }
  Group& group = groups_[index];
  const std::uint32_t generation = std::max(1u, group.generation + 1);
  group = {};
  group.members = std::move(members), group.generation = generation, group.joints = std::move(joints);
  for (const std::uint32_t body : group.members) group_of_[body] = std::uint32_t(index);
  return id_of(index);
}

void Groups::archive_detached(StateArchive& a) const {
  std::vector<GroupId> detached;
  for (std::size_t i = 0; i < groups_.size() && !a.reading(); ++i)
    if (groups_[i].detached) detached.push_back(id_of(i));
  a(detached);
  for (const GroupId id : a.reading() ? detached : std::vector<GroupId>())
    if (!valid(id) || !groups_[id.index].joints.after_promotion)
      throw InputError(fmt::format(
          "the snapshot has a group whose joints are off (index {}, generation {}): found none here, "
          "expected it with the functions that put them on again",
          id.index, id.generation));
}

void Groups::archive(StateArchive& a) {
  const std::vector<Group> before = a.reading() ? groups_ : std::vector<Group>();
  a(groups_, group_of_);
  if (a.reading()) free_.clear(), to_join_.clear();
  for (std::size_t i = 0; i < groups_.size() && a.reading(); ++i) {
    if (groups_[i].members.empty()) free_.push_back(std::uint32_t(i));  // in order, which is a heap
    const bool known = i < before.size() && before[i].generation == groups_[i].generation;
    groups_[i].joints = known ? before[i].joints : GroupJoints{};
    if (known && before[i].detached && !groups_[i].detached) to_join_.push_back(id_of(i));
  }
}

void Groups::note_put(std::uint32_t body) {
  const auto found = group_of_.find(body);
  if (found == group_of_.end()) return;
  Group& group = groups_[found->second];
  if (group.poses.empty()) return;
  const auto place = std::ranges::find(group.members, body) - group.members.begin();
  group.poses[std::size_t(place)] = levels_.state(body);
}

void Groups::join_restored() {
  for (const GroupId id : to_join_)
    if (const auto& join = groups_[id.index].joints.after_promotion) join(id);
  to_join_.clear();
}

bool Groups::valid(GroupId group) const {
  return group && group.index < groups_.size() && groups_[group.index].generation == group.generation &&
         !groups_[group.index].members.empty();
}

void Groups::dissolve(GroupId id) {
  for (const std::uint32_t body : members(id)) group_of_.erase(body);
  set_free(id.index);
}

void Groups::set_free(std::size_t index) {
  groups_[index].clear();
  free_.push_back(std::uint32_t(index));
  std::ranges::push_heap(free_, std::ranges::greater{});
}

void Groups::forget(std::uint32_t body) {
  const auto found = group_of_.find(body);
  if (found == group_of_.end()) return;
  Group& group = groups_[found->second];
  const auto place = std::ranges::find(group.members, body);
  if (!group.poses.empty()) group.poses.erase(group.poses.begin() + (place - group.members.begin()));
  group.members.erase(place);
  if (group.members.empty()) set_free(found->second);
  group_of_.erase(found);
}

GroupId Groups::of(std::uint32_t body) const {
  if (group_of_.empty()) return {};
  const auto found = group_of_.find(body);
  return found == group_of_.end() ? GroupId{} : id_of(found->second);
}

void Groups::wake_together(std::vector<GroupId>& woken) {
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    Group& group = groups_[i];
    if (group.members.empty()) continue;
    const bool all_sleep =
        std::ranges::all_of(group.members, [this](std::uint32_t body) { return levels_.asleep(body); });
    if (group.asleep && !all_sleep)
      for (const std::uint32_t body : group.members) levels_.wake(body);
    if (group.detached && !all_sleep) woken.push_back(id_of(i));
    group.asleep = all_sleep;
  }
}

bool Groups::joined(const Group& group) const {
  return std::ranges::any_of(group.members, [this](std::uint32_t body) { return joined(body); });
}

bool Groups::joined(std::uint32_t body) const {
  const OdeBodyId ode = levels_.bodies[body].ode;
  return ode && has_joints(levels_.full.world()->ode_body(ode));
}

bool Groups::joined_outside(const Group& group, std::uint32_t body) const {
  const auto is_member = [&](dxBody* other) {
    return std::ranges::any_of(group.members, [&](std::uint32_t member) {
      const OdeBodyId ode = levels_.bodies[member].ode;
      return ode && levels_.full.world()->ode_body(ode) == other;
    });
  };
  return std::ranges::any_of(joined_bodies(levels_.full.world()->ode_body(levels_.bodies[body].ode)),
                             [&](dxBody* other) { return other && !is_member(other); });
}

// A joint to a body outside of the group would hold what is gone.
bool Groups::pinned(std::uint32_t body) const {
  if (!joined(body)) return false;
  const auto found = group_of_.find(body);
  if (found == group_of_.end()) return true;
  const Group& group = groups_[found->second];
  return group.refused || !group.asleep || !group.joints.before_demotion || !group.joints.after_promotion ||
         joined_outside(group, body);
}

bool Groups::release(GroupId id) {
  Group& group = groups_[id.index];
  if (!joined(group)) return true;
  if (!group.joints.before_demotion || !group.joints.after_promotion) return false;
  std::vector<RigidState> poses;
  for (const std::uint32_t body : group.members) poses.push_back(levels_.state(body));
  group.joints.before_demotion(id);
  if (joined(group)) return !(group.refused = true);
  group.detached = true;
  group.poses = std::move(poses);
  return true;
}

int Groups::bring_back(GroupId id, Return how) {
  Group& group = groups_[id.index];
  int changed = 0;
  for (std::size_t i = 0; i < group.members.size(); ++i) {
    const std::uint32_t body = group.members[i];
    if (how != Return::asleep) levels_.wake(body);
    RigidState state = levels_.state(body);
    if (!levels_.bodies[body].ode) transfer(levels_, body, Rung::full), ++changed;
    if (how == Return::as_it_slept) {
      state.position = group.poses[i].position, state.orientation = group.poses[i].orientation;
      levels_.full.world()->set_state(levels_.bodies[body].ode, state);
    }
    if (how != Return::asleep) levels_.bodies.level(body).reason = Rule::joined;
  }
  group.detached = false;
  group.asleep = how == Return::asleep;
  group.poses.clear();
  group.joints.after_promotion(id);
  return changed;
}

}  // namespace lodestone
