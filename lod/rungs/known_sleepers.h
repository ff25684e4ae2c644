// Who sleeps in a ball about each mover, as it found when it looked: while it stays in its ball it need not
// look again, until somebody is laid down in that region.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "lod/statistical/sleepers.h"

namespace lodestone {

/// No part of the state: whoever knows of nobody looks, and finds the same.
class KnownSleepers {
 public:
  static constexpr int kMost = 6;  ///< of a ball

  void make_place(std::size_t bodies) { balls_.resize(std::max(balls_.size(), bodies)); }
  void clear() { balls_.assign(balls_.size(), {}); }

  /// All bodies of `support` that sleep within `reach` m of `center`, by the ball of `mover`, and others that
  /// sleep a bit farther away or no more. None where it is not known, or where spheres sleep there.
  std::optional<std::span<const std::int32_t>> near(const Sleepers& sleepers, std::int32_t mover,
                                                    const Vec3& center, double reach) const {
    const Ball& ball = balls_[std::size_t(mover)];
    const double left = ball.reach - reach;
    if (left < 0.0 || (center - ball.center).squaredNorm() > left * left ||
        arrivals_near(sleepers, ball) != ball.arrivals)
      return {};
    return std::span(ball.sleepers).first(ball.count);
  }

  /// For a mover that had to look, and goes on by `way` m in a step: `find(center, reach, add)` calls
  /// add(slot) for all of `support` that sleep in a ball in which it may stay for some steps, and returns
  /// whether there is nobody else.
  template <class Find>
  void look(const Sleepers& sleepers, std::int32_t mover, const Vec3& center, double reach, double way,
            const Find& find) {
    constexpr double kSpare = 0.25;  // over the reach
    constexpr double kSteps = 4.0;
    Ball& ball = balls_[std::size_t(mover)];
    if (ball.wait > 0) return void(--ball.wait);
    ball.center = center, ball.reach = (1.0 + kSpare) * reach + kSteps * way;
    ball.count = 0;
    const std::optional<std::uint64_t> arrivals = arrivals_near(sleepers, ball);
    bool few = true;
    const auto add = [&](std::int32_t slot) {
      few = few && ball.count < kMost;
      if (few) ball.sleepers[ball.count++] = slot;
    };
    if (arrivals && find(ball.center, ball.reach, add) && few) {
      ball.arrivals = *arrivals;
      ball.reach *= 1.0 - 1e-3;
    } else {
      ball.reach = -1.0, ball.wait = kPause;
    }
  }

 private:
  static constexpr std::uint8_t kPause = 8;  // steps: after a ball of too many
  struct Ball {
    Vec3 center = Vec3::Zero();
    double reach = -1.0;         // m; below zero: nothing is known
    std::uint64_t arrivals = 0;  // near it, when it was found
    std::array<std::int32_t, kMost> sleepers;
    std::uint8_t count = 0, wait = 0;  // of sleepers; steps
  };
  static std::optional<std::uint64_t> arrivals_near(const Sleepers& sleepers, const Ball& ball) {
    const auto hulls = sleepers.of(StatisticalModel::support).arrivals_near(ball.center, ball.reach),
               spheres = sleepers.of(StatisticalModel::tables).arrivals_near(ball.center, ball.reach);
    if (!hulls || !spheres) return {};
    return *hulls + *spheres;
  }

  std::vector<Ball> balls_;  // by body
};

}  // namespace lodestone
