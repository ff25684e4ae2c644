// How bodies turn freely, four side by side, several such groups at a time: what advance_orientation
// (flight.h) gives each of them, to the bit, but for those that turn too fast in the time, or are too near a
// pole, to be done with the others.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "lod/simd/wide_loop.h"
#include "lod/statistical/statistical_body.h"

namespace lodestone {

class TurnLanes {
 public:
  static constexpr int kBodies = 32;

  explicit TurnLanes(Simd simd) : simd_(simd) {}

  /// Before turn(); lanes that none is put in are left alone. Not for isotropic kinds.
  void put(int lane, const StatisticalBody& body, const BodyKind& kind);
  /// The first `bodies`, by `time` seconds.
  void turn(double time, int bodies);
  /// Of the body that was put there, normalised as in flight; none where advance_orientation is to be asked.
  std::optional<Quat> orientation(int lane) const {
    const auto at = std::size_t(lane);
    if (known_[at] == 0) return {};
    return Quat(axes_[0][at], axes_[1][at], axes_[2][at], axes_[3][at]);
  }

 private:
  using Lanes = std::array<double, kBodies>;
  struct Loop;
  Simd simd_;
  // w, x, y, z: principal axes to world, after turn() the orientation; principal axes to body axes.
  alignas(32) std::array<Lanes, 4> axes_ = {}, principal_ = {};
  alignas(32) std::array<Lanes, 3> spin_ = {}, inverse_ = {};
  alignas(32) std::array<std::int64_t, kBodies> along_ = {};  // −1: body axes are principal axes
  alignas(32) std::array<std::int64_t, kBodies> known_ = {};  // −1: by turn()
};

}  // namespace lodestone
