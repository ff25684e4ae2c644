// Crowds of balls in the shapes that a broad phase has to deal with.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lod/broad_phase/cell_grid.h"

namespace lodestone {

/// One element a ball.
struct Balls {
  std::vector<double> x, y, z;  // m
  std::vector<float> reach;     // m

  std::size_t size() const { return x.size(); }
  void add(const Vec3& center, double radius);
  bool meet(std::size_t a, std::size_t b) const;
  BallSpan span() const { return {x, y, z, reach}; }
};

struct BallLayout {
  std::string_view name, what;
  Balls (*make)(int balls, std::uint64_t seed);
};

/// layer, pile, sparse, mixed, line, outliers.
std::span<const BallLayout> ball_layouts();

/// Where the balls of `first` are after `steps` steps of 1/60 s: each flies at `speed` m/s, its own way, and
/// back after four steps.
Balls move(const Balls& first, double speed, int steps, std::uint64_t seed);

}  // namespace lodestone
