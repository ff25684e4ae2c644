// Where many balls are and how far they reach, in loops over dense arrays.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "lod/simd/wide_loop.h"

namespace lodestone {

struct BallSpan {
  std::span<const double> x, y, z;  // m, centres
  std::span<const float> reach;     // m, how far from the centre anything can matter in this step
};

struct BallBounds {
  std::array<double, 3> low, high;                                           // m, of the centres
  float most_reach = 0.0f, least_reach = std::numeric_limits<float>::max();  // m
  std::int64_t count = 0;

  BallBounds() {
    low.fill(std::numeric_limits<double>::max()), high.fill(std::numeric_limits<double>::lowest());
  }
  void add(const BallSpan& balls, std::size_t i) {
    ++count;
    most_reach = std::max(most_reach, balls.reach[i]), least_reach = std::min(least_reach, balls.reach[i]);
    low[0] = std::min(low[0], balls.x[i]), high[0] = std::max(high[0], balls.x[i]);
    low[1] = std::min(low[1], balls.y[i]), high[1] = std::max(high[1], balls.y[i]);
    low[2] = std::min(low[2], balls.z[i]), high[2] = std::max(high[2], balls.z[i]);
  }
  void add(const BallBounds& other) {
    count += other.count;
    most_reach = std::max(most_reach, other.most_reach),
    least_reach = std::min(least_reach, other.least_reach);
    for (std::size_t a = 0; a < 3; ++a)
      low[a] = std::min(low[a], other.low[a]), high[a] = std::max(high[a], other.high[a]);
  }
};

/// Of balls [begin, end).
BallBounds find_ball_bounds(const BallSpan& balls, Simd simd, std::int64_t begin, std::int64_t end);

/// Of those whose reach is from `least` to `most`, m: whose `marks` become `mark`, those of others 0.
BallBounds find_bounds_within(const BallSpan& balls, float least, float most, std::uint8_t mark,
                              std::uint8_t* marks, Simd simd, std::int64_t begin, std::int64_t end);

}  // namespace lodestone
