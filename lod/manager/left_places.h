// Places where bodies lay asleep until something woke them: once such a body has left, what slept beside it,
// or on it, is woken, too, and again as it goes on. And sleepers on what lies awake, bodies of the caller's
// among it: they are woken once that has gone from under them. A body that is drawn away, or creeps away,
// touches nothing that it could wake by that.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "lod/body.h"
#include "reference/geometry.h"
#include "reference/state_archive.h"

namespace lodestone {

struct Levels;

class LeftPlaces {
 public:
  /// Where a body is that is new; and of one that the caller has laid to sleep, which wakes nobody.
  void note_place(const Levels& levels, BodyId body);
  void lay(const Levels& levels, BodyId body);
  /// After a step: these fell asleep in it, or slept in another place, and these woke.
  void follow(const Levels& levels, std::span<const BodyId> slept, std::span<const BodyId> moved_and_slept,
              std::span<const BodyId> woke);
  /// At the beginning of a step, after the caller's space was looked at: wakes who slept where somebody left
  /// in the last one, and who has nothing left below.
  void wake(Levels& levels);
  void archive(StateArchive& a) { a(slept_at_, fresh_, laid_, borne_, awake_, left_); }

 private:
  struct Awake {
    BodyId body;
    Vec3 from;          // m, where it lay
    double next = 0.0;  // m from there: so far off it is looked at again who slept beside it
  };
  struct Left {
    Vec3 place;     // m
    double radius;  // m
  };
  struct Borne {
    BodyId sleeper;
    Vec3 place;                 // m, where it sleeps
    BodyId bearer;              // null: the caller's
    std::uint32_t callers = 0;  // his that bears it, FullNeighbor::owner
    Vec3 arm;                   // m, in the bearer's axes: from its centre to that place
  };
  void watch(const Levels& levels, BodyId body, const Vec3& from);
  void watch_sleepers_on(const Levels& levels, BodyId bearer);
  void watch_callers(const Levels& levels);
  void watch(const Levels& levels, BodyId sleeper, const RigidState& bearer_state, BodyId bearer,
             std::uint32_t callers);
  bool is_over(const Levels& levels, const Borne& borne);
  using MayBear = std::function<bool(std::uint32_t body, const Vec3& place, const Vec3& sleeper)>;
  void watch_full_who_bear(const Levels& levels, std::span<const BodyId> slept);
  void watch_statistical_who_bear(const Levels& levels);
  void watch_who_bears(const Levels& levels, std::span<const BodyId> sleepers,
                       std::span<const std::uint32_t> awake, const MayBear& may_bear);

  std::vector<Vec3> slept_at_;  // m, by the body's index
  std::vector<BodyId> fresh_;   // who fell asleep since it was last looked who bears them
  std::vector<BodyId> laid_;    // likewise, of the caller's, or was laid to sleep by him
  std::vector<Borne> borne_;    // sleepers, each with one that bears it and is awake, or is the caller's
  std::vector<Awake> awake_;    // who woke and has not left altogether yet
  std::vector<Left> left_;      // in the last step
};

}  // namespace lodestone
