// How far a hull reaches from its centre of mass in a direction: its support function, sampled over an
// octahedral map (Cigolle et al., A survey of efficient representations for independent unit vectors, 2014),
// which needs no trigonometry to read.
#pragma once

#include <span>

#include "lod/simd/lane_math.h"
#include "reference/shape.h"

namespace lodestone {

inline constexpr int kHullHeightSide = 24;  // cells along an edge of the map: 5° apart on average
inline constexpr int kHullHeights = (kHullHeightSide + 1) * (kHullHeightSide + 1);

/// Of kHullHeights directions, m: how far the hull reaches, as the ground meets it, and how far it keeps
/// others' centres away, along the line of centres.
void sample_hull_heights(const Shape& shape, std::span<float> heights, std::span<float> reaches);

/// m, of the rolling resistance of hulls among others: a sphere rolls on where a hull lies on a face or falls
/// from edge to edge, and each of these holds it by its weight times what its lowest point lies beside the
/// centre of mass. Part of the mean of that over all directions; 0 of a ball.
double find_rolling_lever(const Shape& shape);

/// m, along `direction` (body axes, of any length but 0), linear between four samples of the map that begins
/// at `heights[first]`.
LODESTONE_INLINE float read_hull_height(const float* heights, int first, lane::F3 direction) {
  using namespace lane;
  const float whole = absolute(direction.x) + absolute(direction.y) + absolute(direction.z),
              scale = 1.0f / most(whole, 1e-30f);
  const float x = direction.x * scale, y = direction.y * scale;
  // The lower half is folded out over the map's corners.
  const float over_x = choose(x < 0.0f, absolute(y) - 1.0f, 1.0f - absolute(y)),
              over_y = choose(y < 0.0f, absolute(x) - 1.0f, 1.0f - absolute(x));
  constexpr float kHalf = 0.5f * float(kHullHeightSide), kLast = float(kHullHeightSide) - 0.01f;
  const bool below = direction.z < 0.0f;
  const float u = (choose(below, over_x, x) + 1.0f) * kHalf, v = (choose(below, over_y, y) + 1.0f) * kHalf;
  const int column = int(least(u, kLast)), row = int(least(v, kLast));
  const float s = u - float(column), t = v - float(row);
  const int at = first + row * (kHullHeightSide + 1) + column, next = at + kHullHeightSide + 1;
  const float low = heights[at] + s * (heights[at + 1] - heights[at]),
              high = heights[next] + s * (heights[next + 1] - heights[next]);
  return low + t * (high - low);
}

}  // namespace lodestone
