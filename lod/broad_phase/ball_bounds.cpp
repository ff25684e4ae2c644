#include "lod/broad_phase/ball_bounds.h"

#include "lod/simd/lane_math.h"

namespace lodestone {
namespace {

using namespace lane;

constexpr std::int64_t kLanes = 16;  // bounds side by side, so that none waits for the one before
constexpr double kFar = std::numeric_limits<double>::max();

struct LaneBounds {
  alignas(64) double low[3][kLanes], high[3][kLanes];
  alignas(64) float least[kLanes], most[kLanes];

  LODESTONE_INLINE LaneBounds() {
    for (std::int64_t l = 0; l < kLanes; ++l) {
      for (int a = 0; a < 3; ++a) low[a][l] = kFar, high[a][l] = -kFar;
      least[l] = std::numeric_limits<float>::max(), most[l] = 0.0f;
    }
  }
  void give_to(BallBounds& bounds) const {
    for (std::size_t l = 0; l < std::size_t(kLanes); ++l) {
      for (std::size_t a = 0; a < 3; ++a)
        bounds.low[a] = std::min(bounds.low[a], low[a][l]),
        bounds.high[a] = std::max(bounds.high[a], high[a][l]);
      bounds.least_reach = std::min(bounds.least_reach, least[l]),
      bounds.most_reach = std::max(bounds.most_reach, most[l]);
    }
  }
};

template <bool OnlyWithin>
struct BoundsLoop {
  const BallSpan& balls;
  float least_within, most_within;
  std::uint8_t mark;
  std::uint8_t* marks;
  BallBounds& bounds;

  LODESTONE_INLINE void operator()(std::int64_t begin, std::int64_t end) const {
    const std::array<const double*, 3> centers{balls.x.data(), balls.y.data(), balls.z.data()};
    const float* reach = balls.reach.data();
    LaneBounds found;
    const std::int64_t last = begin + (end - begin) / kLanes * kLanes;
    for (std::int64_t i = begin; i < last; i += kLanes) {
      alignas(64) std::int64_t within[kLanes];  // masks
      for (std::int64_t l = 0; l < kLanes; ++l) {
        const float r = reach[i + l];
        const int in = OnlyWithin ? -(int(r >= least_within) & int(r <= most_within)) : -1;
        within[l] = in;
        found.least[l] = least(found.least[l], select(in, r, std::numeric_limits<float>::max()));
        found.most[l] = most(found.most[l], select(in, r, 0.0f));
      }
      for (std::size_t a = 0; a < 3; ++a)
        for (std::int64_t l = 0; l < kLanes; ++l) {
          const double at = centers[a][i + l], low = OnlyWithin ? select(within[l], at, kFar) : at,
                       high = OnlyWithin ? select(within[l], at, -kFar) : at;
          found.low[a][l] = low < found.low[a][l] ? low : found.low[a][l];
          found.high[a][l] = high > found.high[a][l] ? high : found.high[a][l];
        }
    }
    found.give_to(bounds);
    if constexpr (OnlyWithin) {
      std::int64_t count = 0;
      for (std::int64_t i = begin; i < last; ++i) {
        const int in = -(int(reach[i] >= least_within) & int(reach[i] <= most_within));
        marks[i] = std::uint8_t(in & mark);
        count -= in;
      }
      bounds.count = count;
    } else {
      bounds.count = last - begin;
    }
    for (std::int64_t i = last; i < end; ++i) {
      const int in = !OnlyWithin ? -1 : -(int(reach[i] >= least_within) & int(reach[i] <= most_within));
      if constexpr (OnlyWithin) marks[i] = std::uint8_t(in & mark);
      if (in) bounds.add(balls, std::size_t(i));
    }
  }
};

}  // namespace

BallBounds find_ball_bounds(const BallSpan& balls, Simd simd, std::int64_t begin, std::int64_t end) {
  BallBounds bounds;
  run_wide(simd, BoundsLoop<false>{balls, 0.0f, 0.0f, 0, nullptr, bounds}, begin, end);
  return bounds;
}

BallBounds find_bounds_within(const BallSpan& balls, float least, float most, std::uint8_t mark,
                              std::uint8_t* marks, Simd simd, std::int64_t begin, std::int64_t end) {
  BallBounds bounds;
  run_wide(simd, BoundsLoop<true>{balls, least, most, mark, marks, bounds}, begin, end);
  return bounds;
}

}  // namespace lodestone
