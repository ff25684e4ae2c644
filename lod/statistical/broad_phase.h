// Which bounding spheres are near each other: a uniform grid of hashed cells, filled by a counting sort, so that bodies of a cell lie
// together in memory (Teschner et al., Optimized spatial hashing, 2003). The sleepers' grid is rebuilt only when who sleeps changes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "reference/geometry.h"

namespace lodestone {

/// A bounding sphere that has been grown by how far its body may move in the step.
struct Bound {
  Vec3 center = Vec3::Zero();
  double reach = 0.0;  ///< m
};

/// Two overlapping bounds; `first` is always a mover.
struct NearPair {
  std::int32_t first = 0, second = 0;
};

class BroadPhase {
 public:
  /// The bounds that stand still until the next call; indices are theirs in `still`.
  void set_still(std::span<const Bound> still);

  /// Every overlapping pair of `moving` with `moving` (first < second), appended to `pairs`; then of `moving` with what stands still, `second` being
  /// −1 − (index of the still one). The order depends on the bounds alone.
  void find_pairs(std::span<const Bound> moving, std::vector<NearPair>& pairs);

 private:
  struct Grid {
    double cell = 1.0;
    std::uint32_t mask = 0;
    std::vector<std::uint32_t> start;       // of each bucket, size buckets + 1
    std::vector<Bound> bounds;              // in bucket order
    std::vector<std::int32_t> index;        // of each in the span given
    std::vector<std::int32_t> outsized;     // bounds too large for the cells: tested against everything
    std::vector<std::uint32_t> bucket_of;   // scratch
    void fill(std::span<const Bound> bounds, double cell);
  };

  std::vector<Bound> still_bounds_;
  Grid moving_, still_;
};

}  // namespace lodestone
