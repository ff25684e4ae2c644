// Counter-based random numbers (Philox4x32-10; Salmon et al., Parallel random numbers: as easy as 1, 2, 3,
// 2011). A draw depends on its key only, never on call order, so any thread count and any split of work gives
// the same values.
#pragma once

#include <Random123/philox.h>

#include <cstdint>
#include <numbers>

#include "reference/geometry.h"

namespace lodestone {

/// The stream of draws that belongs to (seed, a, b): say (seed, body, event) or (seed, cell, trial).
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::uint64_t a, std::uint32_t b)
      : counter_{{std::uint32_t(a), std::uint32_t(a >> 32), b, 0}},
        key_{{std::uint32_t(seed), std::uint32_t(seed >> 32)}} {}

  /// Uniform in (0, 1), both ends left out.
  double uniform() {
    if (left_ == 0) refill();
    return (block_[--left_] + 0.5) * 0x1p-32;
  }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// Standard normal (Box–Muller; one value a call, so that draws stay countable).
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }

  /// Uniform on the unit sphere.
  Vec3 direction() {
    const double z = uniform(-1.0, 1.0), angle = uniform(0.0, 2.0 * std::numbers::pi);
    const double r = std::sqrt(1.0 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
  }

  /// Uniform over rotations (Shoemake, Uniform random rotations, 1992).
  Quat orientation() {
    const double u = uniform(), a = uniform(0.0, 2.0 * std::numbers::pi),
                 b = uniform(0.0, 2.0 * std::numbers::pi);
    const double r = std::sqrt(1.0 - u), s = std::sqrt(u);
    return Quat(s * std::cos(b), r * std::sin(a), r * std::cos(a), s * std::sin(b));
  }

 private:
  void refill() {
    block_ = r123::Philox4x32{}(counter_, key_);
    ++counter_[3];
    left_ = 4;
  }

  r123::Philox4x32::ctr_type counter_, block_{};
  r123::Philox4x32::key_type key_;
  int left_ = 0;
};

}  // namespace lodestone
