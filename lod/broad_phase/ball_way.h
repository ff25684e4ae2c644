// A ball on its straight way through a step. What goes farther than its own size would be near all that its
// way's ball meets; two that go side by side are not near each other for that.
#pragma once

#include "reference/geometry.h"

namespace lodestone {

struct BallWay {
  Vec3 middle = Vec3::Zero();    // m: where it is halfway
  Vec3 half_way = Vec3::Zero();  // m
  double radius = 0.0;           // m
  bool is_long() const { return half_way.squaredNorm() > radius * radius; }
};

/// Whether two on long ways meet at no time, as long as neither leaves its way.
inline bool pass(const BallWay& a, const BallWay& b) {
  if (!a.is_long() || !b.is_long()) return false;
  const double limit = a.radius + b.radius + (a.half_way - b.half_way).norm();
  return (a.middle - b.middle).squaredNorm() >= limit * limit;
}

}  // namespace lodestone
