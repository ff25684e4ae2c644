#include "lod/statistical/turn_lanes.h"

#include <cmath>
#include <cstring>

#include "lod/simd/lanes.h"
#include "lod/statistical/flight.h"

namespace lodestone {
namespace {

using lane::D4, lane::V4, lane::Mask4;

LODESTONE_INLINE D4 load(const double* from) {
  D4 lanes;
  std::memcpy(&lanes, from, sizeof lanes);
  return lanes;
}
template <class Lanes, class Value>
LODESTONE_INLINE void store(const Lanes& lanes, Value* to) {
  std::memcpy(to, &lanes, sizeof lanes);
}

struct QuatLanes {
  D4 w, x, y, z;
};

// As Eigen does it two numbers at a time.
LODESTONE_INLINE QuatLanes operator*(const QuatLanes& a, const QuatLanes& b) {
  return {
      (a.w * b.w - a.y * b.y) - (a.z * b.z + a.x * b.x), (a.w * b.x + a.y * b.z) - (a.z * b.y - a.x * b.w),
      (a.w * b.y + a.y * b.w) + (a.z * b.x - a.x * b.z), (a.w * b.z - a.y * b.x) + (a.z * b.w + a.x * b.y)};
}
LODESTONE_INLINE QuatLanes operator*(const D4& s, const QuatLanes& a) {
  return {a.w * s, a.x * s, a.y * s, a.z * s};
}
LODESTONE_INLINE QuatLanes choose(const Mask4& which, const QuatLanes& a, const QuatLanes& b) {
  return {which ? a.w : b.w, which ? a.x : b.x, which ? a.y : b.y, which ? a.z : b.z};
}

struct Turning {
  D4 w;
  D4 v[3];
  D4 spin[3];
  Mask4 known;
};

// turn_about_own.
template <int Axis>
LODESTONE_INLINE void turn_about(const D4& angle, Turning& t) {
  constexpr int kNext = (Axis + 1) % 3, kLast = (Axis + 2) % 3;
  const D4 half = 0.5 * angle, square = half * half;
  t.known &= lane::absolute(half) < kSmallAngle;
  const D4 sine = half * small_sine_over_angle(square), cosine = small_cosine(square);
  const D4 w = t.w, own = t.v[Axis], next = t.v[kNext], last = t.v[kLast];
  t.w = w * cosine - own * sine;
  t.v[Axis] = own * cosine + w * sine;
  t.v[kNext] = next * cosine + last * sine;
  t.v[kLast] = last * cosine - next * sine;
  const D4 whole_sine = 2.0 * sine * cosine, whole_cosine = 1.0 - 2.0 * sine * sine, at_next = t.spin[kNext],
           at_last = t.spin[kLast];
  t.spin[kNext] = at_next * whole_cosine + at_last * whole_sine;
  t.spin[kLast] = at_last * whole_cosine - at_next * whole_sine;
}

// turn_to_energy, but for its way over a pole.
LODESTONE_INLINE V4 turn_to(const V4& own, const V4& inverse, const D4& twice_energy, Mask4& known) {
  const auto times = [](const V4& a, const V4& b) { return V4{a.x * b.x, a.y * b.y, a.z * b.z}; };
  const V4 omega = times(inverse, own);
  const D4 now = dot(own, omega), excess = now - twice_energy, square = dot(own, own);
  const Mask4 none = ~(lane::absolute(excess) > 1e-14 * now);
  const D4 one = lane::all<D4>(1.0);
  const auto divisor = [&](const D4& d) { return d > 0.0 ? d : one; };  // who has none there is not turned so
  const D4 inverse_square = 1.0 / divisor(square);
  const V4 across = omega - (now * inverse_square) * own;
  const D4 slope = dot(across, across),
           curve = dot(across, times(inverse, across)) - twice_energy * slope * inverse_square;
  const D4 inverse_slope = 1.0 / divisor(slope), bend = curve * excess * inverse_slope * inverse_slope;
  known &= none | ((slope * square > 1e-18 * now * now) & (bend <= 1.0));
  const D4 zero = {};
  const D4 far = 1.0 / (1.0 + lane::square_root(lane::most(zero, 1.0 - bend)));
  const D4 x =
      -excess * inverse_slope * (lane::absolute(bend) < 1e-3 ? 0.5 + bend * (0.125 + 0.0625 * bend) : far);
  const D4 t = x * x * slope * inverse_square;
  const D4 wide = 1.0 / (1.0 + lane::square_root(lane::most(zero, 1.0 + t)));
  const D4 share = x * inverse_square * (t < 1e-4 ? 0.5 - t * (0.125 - 0.0625 * t) : wide);
  const V4 half = cross(own, omega);
  return {none ? zero : half.x * share, none ? zero : half.y * share, none ? zero : half.z * share};
}

}  // namespace

struct TurnLanes::Loop {
  TurnLanes& all;
  double time;
  LODESTONE_INLINE void operator()(std::int64_t begin, std::int64_t end) const;
  LODESTONE_INLINE void turn_four(std::size_t first) const;
};

// Of the groups that begin with the bodies `begin`, `begin` + 4, …
LODESTONE_INLINE void TurnLanes::Loop::operator()(std::int64_t begin, std::int64_t end) const {
  for (; begin < end; begin += 4) turn_four(std::size_t(begin));
}

LODESTONE_INLINE void TurnLanes::Loop::turn_four(std::size_t first) const {
  const auto three = [&](const std::array<Lanes, 3>& from) {
    return V4{load(&from[0][first]), load(&from[1][first]), load(&from[2][first])};
  };
  const V4 spin = three(all.spin_), inverse = three(all.inverse_);
  const D4 axes[4] = {load(&all.axes_[0][first]), load(&all.axes_[1][first]), load(&all.axes_[2][first]),
                      load(&all.axes_[3][first])};

  // rotation_from_vector
  const V4 v = (inverse.y * time) * spin;
  const D4 square = 0.25 * dot(v, v), half_sine = 0.5 * small_sine_over_angle(square);
  const QuatLanes of_ball{small_cosine(square), half_sine * v.x, half_sine * v.y, half_sine * v.z};

  // into principal axes, as Eigen turns a vector
  const V4 back{-axes[1], -axes[2], -axes[3]};
  V4 twice = cross(back, spin);
  twice = twice + twice;
  V4 own = spin + axes[0] * twice + cross(back, twice);
  const D4 asked = dot(own, V4{inverse.x * own.x, inverse.y * own.y, inverse.z * own.z});
  const D4 widest = lane::most(inverse.y - inverse.x, inverse.z - inverse.y) * time,
           angle_squared = dot(own, own) * widest * widest;

  Turning t{axes[0], {axes[1], axes[2], axes[3]}, {own.x, own.y, own.z}, {}};
  t.known = (square < kSmallAngle * kSmallAngle) & (angle_squared <= kTurnOfRound * kTurnOfRound);
  turn_about<0>((inverse.x - inverse.y) * t.spin[0] * (0.5 * time), t);
  turn_about<2>((inverse.z - inverse.y) * t.spin[2] * time, t);
  turn_about<0>((inverse.x - inverse.y) * t.spin[0] * (0.5 * time), t);
  own = {t.spin[0], t.spin[1], t.spin[2]};
  const Mask4 corrected = angle_squared > kNoTurn * kNoTurn;
  Mask4 reached = t.known;
  const V4 half = turn_to(own, inverse, asked, reached);

  // turned_back
  const D4 one = lane::all<D4>(1.0), tilt = dot(half, half);
  const D4 scale = tilt < 1e-5 ? 1.0 - tilt * (0.5 - 0.375 * tilt) : 1.0 / lane::square_root(1.0 + tilt);
  const QuatLanes as_split{t.w, t.v[0], t.v[1], t.v[2]};
  QuatLanes turned =
      choose(corrected, scale * (as_split * QuatLanes{one, -half.x, -half.y, -half.z}), as_split);
  Mask4 along;
  std::memcpy(&along, &all.along_[first], sizeof along);
  const QuatLanes to_axes{load(&all.principal_[0][first]), -load(&all.principal_[1][first]),
                          -load(&all.principal_[2][first]), -load(&all.principal_[3][first])};
  turned = of_ball * choose(along, turned, turned * to_axes);
  const D4 length = (turned.x * turned.x + turned.z * turned.z) + (turned.y * turned.y + turned.w * turned.w);
  turned = (1.5 - 0.5 * length) * turned;

  store(corrected ? reached : t.known, &all.known_[first]);
  store(turned.w, &all.axes_[0][first]), store(turned.x, &all.axes_[1][first]);
  store(turned.y, &all.axes_[2][first]), store(turned.z, &all.axes_[3][first]);
}

void TurnLanes::put(int lane, const StatisticalBody& body, const BodyKind& kind) {
  const auto at = std::size_t(lane);
  const bool along = kind.along_principal_axes;
  const Quat axes = along ? body.orientation : Quat(body.orientation * kind.principal_axes);
  const auto set = [&](std::array<Lanes, 4>& to, const Quat& q) {
    to[0][at] = q.w(), to[1][at] = q.x(), to[2][at] = q.y(), to[3][at] = q.z();
  };
  set(axes_, axes), set(principal_, kind.principal_axes);
  along_[at] = along ? -1 : 0;
  for (std::size_t i = 0; i < 3; ++i)
    spin_[i][at] = body.spin[int(i)], inverse_[i][at] = kind.inverse_moments[int(i)];
}

void TurnLanes::turn(double time, int bodies) { run_wide(simd_, Loop{*this, time}, 0, bodies); }

}  // namespace lodestone
