// Four doubles or eight floats side by side, and vectors of them: so many contacts are computed at once, with
// the same result to the bit on every processor.
#pragma once

#include <concepts>
#include <cstdint>
#include <type_traits>

#include "lod/simd/wide_loop.h"

namespace lodestone::lane {

using D4 = double __attribute__((vector_size(32)));
using F8 = float __attribute__((vector_size(32)));

template <class L>
concept Lanes = std::same_as<L, D4> || std::same_as<L, F8>;

/// What a lane holds, and how many there are.
template <Lanes L>
using Real = std::conditional_t<std::same_as<L, D4>, double, float>;
template <Lanes L>
inline constexpr int kLanes = int(sizeof(L) / sizeof(Real<L>));
/// −1: yes, 0: no.
template <Lanes L>
using Mask = decltype(L{} < L{});

template <Lanes L>
LODESTONE_INLINE L all(Real<L> x) {
  return x - L{};
}
template <Lanes L>
LODESTONE_INLINE L most(const L& a, const L& b) {
  return a > b ? a : b;
}
template <Lanes L>
LODESTONE_INLINE L least(const L& a, const L& b) {
  return a < b ? a : b;
}
template <Lanes L>
LODESTONE_INLINE L absolute(const L& a) {
  return most(a, -a);
}
template <Lanes L>
LODESTONE_INLINE L square_root(const L& a) {
  L root;
  for (int i = 0; i < kLanes<L>; ++i)
    if constexpr (std::same_as<L, D4>)
      root[i] = __builtin_sqrt(a[i]);
    else
      root[i] = __builtin_sqrtf(a[i]);
  return root;
}

using Mask4 = Mask<D4>;
using Mask8 = Mask<F8>;
LODESTONE_INLINE bool any(const Mask4& which) { return (which[0] | which[1] | which[2] | which[3]) != 0; }
LODESTONE_INLINE bool any(const Mask8& which) { return any(__builtin_bit_cast(Mask4, which)); }

template <Lanes L>
struct Vec3Lanes {
  L x, y, z;
};

template <Lanes L>
LODESTONE_INLINE Vec3Lanes<L> operator+(const Vec3Lanes<L>& a, const Vec3Lanes<L>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <Lanes L>
LODESTONE_INLINE Vec3Lanes<L> operator-(const Vec3Lanes<L>& a, const Vec3Lanes<L>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <Lanes L>
LODESTONE_INLINE Vec3Lanes<L> operator*(const L& s, const Vec3Lanes<L>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <Lanes L>
LODESTONE_INLINE L dot(const Vec3Lanes<L>& a, const Vec3Lanes<L>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <Lanes L>
LODESTONE_INLINE Vec3Lanes<L> cross(const Vec3Lanes<L>& a, const Vec3Lanes<L>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <Lanes L>
LODESTONE_INLINE Vec3Lanes<L> choose(const Mask<L>& which, const Vec3Lanes<L>& a, const Vec3Lanes<L>& b) {
  return {which ? a.x : b.x, which ? a.y : b.y, which ? a.z : b.z};
}

/// Symmetric.
template <Lanes L>
struct TensorLanes {
  L xx, yy, zz, xy, xz, yz;
};
template <Lanes L>
LODESTONE_INLINE Vec3Lanes<L> operator*(const TensorLanes<L>& m, const Vec3Lanes<L>& a) {
  return {m.xx * a.x + m.xy * a.y + m.xz * a.z, m.xy * a.x + m.yy * a.y + m.yz * a.z,
          m.xz * a.x + m.yz * a.y + m.zz * a.z};
}

using V4 = Vec3Lanes<D4>;
using V8 = Vec3Lanes<F8>;

/// Rows to columns: lane i of the result's x, y, z is the first, second, third of row i.
LODESTONE_INLINE V4 columns_of(const D4& r0, const D4& r1, const D4& r2, const D4& r3) {
  const D4 low01 = __builtin_shufflevector(r0, r1, 0, 4, 2, 6),
           high01 = __builtin_shufflevector(r0, r1, 1, 5, 3, 7);
  const D4 low23 = __builtin_shufflevector(r2, r3, 0, 4, 2, 6),
           high23 = __builtin_shufflevector(r2, r3, 1, 5, 3, 7);
  return {__builtin_shufflevector(low01, low23, 0, 1, 4, 5),
          __builtin_shufflevector(high01, high23, 0, 1, 4, 5),
          __builtin_shufflevector(low01, low23, 2, 3, 6, 7)};
}
/// The way back; the fourth of each row is 0.
LODESTONE_INLINE void rows_of(const V4& v, D4 (&rows)[4]) {
  const D4 none = {};
  const D4 xy_even = __builtin_shufflevector(v.x, v.y, 0, 4, 2, 6),
           xy_odd = __builtin_shufflevector(v.x, v.y, 1, 5, 3, 7);
  const D4 z_even = __builtin_shufflevector(v.z, none, 0, 4, 2, 6),
           z_odd = __builtin_shufflevector(v.z, none, 1, 5, 3, 7);
  rows[0] = __builtin_shufflevector(xy_even, z_even, 0, 1, 4, 5);
  rows[1] = __builtin_shufflevector(xy_odd, z_odd, 0, 1, 4, 5);
  rows[2] = __builtin_shufflevector(xy_even, z_even, 2, 3, 6, 7);
  rows[3] = __builtin_shufflevector(xy_odd, z_odd, 2, 3, 6, 7);
}

// Within each half of eight floats: the first two of a and b in turn, the last two; the lower halves of a and
// b, the upper ones.
LODESTONE_INLINE F8 first_in_turn(const F8& a, const F8& b) {
  return __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13);
}
LODESTONE_INLINE F8 last_in_turn(const F8& a, const F8& b) {
  return __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
}
LODESTONE_INLINE F8 first_pairs(const F8& a, const F8& b) {
  return __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13);
}
LODESTONE_INLINE F8 last_pairs(const F8& a, const F8& b) {
  return __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
}
LODESTONE_INLINE F8 lower_halves(const F8& a, const F8& b) {
  return __builtin_shufflevector(a, b, 0, 1, 2, 3, 8, 9, 10, 11);
}
LODESTONE_INLINE F8 upper_halves(const F8& a, const F8& b) {
  return __builtin_shufflevector(a, b, 4, 5, 6, 7, 12, 13, 14, 15);
}

/// Rows of two vectors each, in the first three of either half, to columns.
LODESTONE_INLINE void columns_of(const F8 (&r)[8], V8& lower, V8& upper) {
  const F8 xy01 = first_in_turn(r[0], r[1]), z01 = last_in_turn(r[0], r[1]), xy23 = first_in_turn(r[2], r[3]),
           z23 = last_in_turn(r[2], r[3]);
  const F8 xy45 = first_in_turn(r[4], r[5]), z45 = last_in_turn(r[4], r[5]), xy67 = first_in_turn(r[6], r[7]),
           z67 = last_in_turn(r[6], r[7]);
  const F8 x0123 = first_pairs(xy01, xy23), y0123 = last_pairs(xy01, xy23), z0123 = first_pairs(z01, z23);
  const F8 x4567 = first_pairs(xy45, xy67), y4567 = last_pairs(xy45, xy67), z4567 = first_pairs(z45, z67);
  lower = {lower_halves(x0123, x4567), lower_halves(y0123, y4567), lower_halves(z0123, z4567)};
  upper = {upper_halves(x0123, x4567), upper_halves(y0123, y4567), upper_halves(z0123, z4567)};
}
LODESTONE_INLINE void four_rows_of(const F8& x, const F8& y, const F8& z, F8* rows) {
  const F8 none = {};
  const F8 xy_first = first_in_turn(x, y), xy_last = last_in_turn(x, y), z_first = first_in_turn(z, none),
           z_last = last_in_turn(z, none);
  rows[0] = first_pairs(xy_first, z_first), rows[1] = last_pairs(xy_first, z_first);
  rows[2] = first_pairs(xy_last, z_last), rows[3] = last_pairs(xy_last, z_last);
}
/// The way back; the fourth of either half is 0.
LODESTONE_INLINE void rows_of(const V8& lower, const V8& upper, F8 (&rows)[8]) {
  four_rows_of(lower_halves(lower.x, upper.x), lower_halves(lower.y, upper.y), lower_halves(lower.z, upper.z),
               rows);
  four_rows_of(upper_halves(lower.x, upper.x), upper_halves(lower.y, upper.y), upper_halves(lower.z, upper.z),
               rows + 4);
}

}  // namespace lodestone::lane
