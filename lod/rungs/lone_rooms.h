// Balls about bodies that move, so large that each body stays within its own for some steps: where none of
// them meets another or a sleeper, no two bodies can be near until one of them leaves its room.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "lod/body.h"
#include "reference/geometry.h"

namespace lodestone {

class LoneRooms {
 public:
  /// Of the slots below `bodies`.
  void make_place(StatisticalModel model, std::size_t bodies) {
    std::vector<Room>& rooms = rooms_[std::size_t(model)];
    rooms.resize(std::max(rooms.size(), bodies));
  }

  /// Whether there are rooms: none of them meets another, nor what slept when they were given.
  bool stand() const { return stand_; }
  /// Of all who slept then, and of those that fell asleep in their rooms since: how often anybody was ever
  /// laid to sleep.
  std::uint64_t laid = 0;

  /// Whether new ones are worth a try in this step, after one in which nobody was near another.
  bool are_due() { return wait_ == 0 || --wait_ == 0; }
  /// s in which no body should leave its room, for steps of `dt` seconds.
  double time(double dt) const { return steps_ * dt; }
  /// Those of before are none any more.
  void begin() { ++number_, stand_ = false; }
  void give(StatisticalModel model, std::int32_t slot, const Vec3& center, double reach) {
    rooms_[std::size_t(model)][std::size_t(slot)] = {center, reach, number_};
  }
  /// All have theirs: `apart` if none meets another.
  void end(bool apart) {
    stand_ = apart;
    steps_ = apart ? std::min(2 * steps_, kMostSteps) : std::max(steps_ / 2, kLeastSteps);
    pause_ = apart ? 1 : std::min(2 * pause_, kLongestPause);
    wait_ = apart ? 0 : pause_;
  }
  void give_up() { stand_ = false; }

  /// Whether the ball lies within the room of the body of that slot.
  bool holds(StatisticalModel model, std::int32_t slot, const Vec3& center, double reach) const {
    const std::vector<Room>& rooms = rooms_[std::size_t(model)];
    if (std::size_t(slot) >= rooms.size()) return false;
    const Room& room = rooms[std::size_t(slot)];
    const double left = room.reach - reach;
    return room.number == number_ && left >= 0.0 && (center - room.center).squaredNorm() <= left * left;
  }

 private:
  static constexpr int kLeastSteps = 4, kMostSteps = 16, kLongestPause = 64;
  struct Room {
    Vec3 center = Vec3::Zero();  // m
    double reach = 0.0;          // m
    std::uint64_t number = 0;    // of the rooms that were given together
  };
  std::array<std::vector<Room>, 2> rooms_;  // of each statistical rung, by slot
  std::uint64_t number_ = 1;
  bool stand_ = false;
  int steps_ = 8;
  int pause_ = 1, wait_ = 0;  // steps: from one failure to the next try, what is left of it
};

}  // namespace lodestone
