// The groups that a caller has named: who is in which, which sleep, and those whose joints the caller has
// taken off for the time being.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "lod/groups.h"
#include "lod/manager/levels.h"
#include "reference/state_archive.h"

namespace lodestone {

class Groups {
 public:
  explicit Groups(Levels& levels) : levels_(levels) {}

  /// Null where a body is in a group already, or twice in the list.
  GroupId make(std::span<const std::uint32_t> bodies, GroupJoints joints);
  bool valid(GroupId group) const;
  void dissolve(GroupId group);
  void forget(std::uint32_t body);

  /// Comes before archive(). Throws InputError where joints are off that no functions here would put on
  /// again.
  void archive_detached(StateArchive& a) const;
  /// A group's functions are the reader's, where he has the group.
  void archive(StateArchive& a);

  bool empty() const { return group_of_.empty(); }
  /// Of one that is in none: null.
  GroupId of(std::uint32_t body) const;
  std::span<const std::uint32_t> members(GroupId group) const { return groups_[group.index].members; }

  /// Who wakes wakes the others. Adds those of groups whose joints are off, which must be full at once, to
  /// `woken`.
  void wake_together(std::vector<GroupId>& woken);

  /// Whether a body is full and on joints.
  bool joined(std::uint32_t body) const;
  /// Whether joints hold a body at the full level.
  bool pinned(std::uint32_t body) const;
  /// Has the caller take the joints off, where there are any; whether the group may leave the full level.
  bool release(GroupId group);
  /// Where a group is brought back whose joints are off.
  enum class Return : std::uint8_t {
    asleep,       ///< as it lies
    awake,        ///< as it is now: something woke it between steps
    as_it_slept,  ///< at the poses in which it slept, with the velocities that it was given in this step
  };
  bool detached(GroupId group) const { return groups_[group.index].detached; }
  /// The caller put a body elsewhere, or to sleep: it slept there, from now on.
  void note_put(std::uint32_t body);
  /// After all is as in the snapshot: has the caller join those whose joints were off before and are on in
  /// it.
  void join_restored();
  /// Moves it to the full level and has the caller join it. Returns how many bodies changed.
  int bring_back(GroupId group, Return how);

 private:
  struct Group {
    std::vector<std::uint32_t> members;  // in order; empty: free
    std::uint32_t generation = 0;
    GroupJoints joints;
    bool asleep = false;            // all of it, when that was last asked
    bool detached = false;          // its joints are off
    bool refused = false;           // the caller left a joint on when it was asked
    std::vector<RigidState> poses;  // of the members, while its joints are off
    void archive(StateArchive& a) { a(members, generation, asleep, detached, refused, poses); }
    void clear() {
      const std::uint32_t last = generation;
      *this = {};
      generation = last;
    }
  };
  GroupId id_of(std::size_t index) const { return {std::uint32_t(index), groups_[index].generation}; }
  bool joined(const Group& group) const;
  bool joined_outside(const Group& group, std::uint32_t body) const;

  Levels& levels_;
  void set_free(std::size_t index);

  std::vector<GroupId> to_join_;  // join_restored()
  std::vector<Group> groups_;
  std::vector<std::uint32_t> free_;  // indices without a group: a heap, the least on top
  std::unordered_map<std::uint32_t, std::uint32_t> group_of_;
};

}  // namespace lodestone
