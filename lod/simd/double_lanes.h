// Four doubles side by side, and vectors of them: four contacts are computed at once, with the same result to
// the bit on every processor.
#pragma once

#include <cstdint>

#include "lod/simd/wide_loop.h"

namespace lodestone::lane {

inline constexpr int kLanes = 4;
using D4 = double __attribute__((vector_size(32)));
using Mask4 = std::int64_t __attribute__((vector_size(32)));  // −1: yes, 0: no

LODESTONE_INLINE D4 all(double x) { return D4{x, x, x, x}; }
LODESTONE_INLINE D4 most(const D4& a, const D4& b) { return a > b ? a : b; }
LODESTONE_INLINE D4 least(const D4& a, const D4& b) { return a < b ? a : b; }
LODESTONE_INLINE D4 absolute(const D4& a) { return most(a, -a); }
LODESTONE_INLINE bool any(const Mask4& which) { return (which[0] | which[1] | which[2] | which[3]) != 0; }
LODESTONE_INLINE D4 square_root(const D4& a) {
  return D4{__builtin_sqrt(a[0]), __builtin_sqrt(a[1]), __builtin_sqrt(a[2]), __builtin_sqrt(a[3])};
}

struct V4 {
  D4 x, y, z;
};

LODESTONE_INLINE V4 operator+(const V4& a, const V4& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
LODESTONE_INLINE V4 operator-(const V4& a, const V4& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
LODESTONE_INLINE V4 operator*(const D4& s, const V4& a) { return {s * a.x, s * a.y, s * a.z}; }
LODESTONE_INLINE D4 dot(const V4& a, const V4& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
LODESTONE_INLINE V4 cross(const V4& a, const V4& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Symmetric.
struct Tensor4 {
  D4 xx, yy, zz, xy, xz, yz;
};
LODESTONE_INLINE V4 operator*(const Tensor4& m, const V4& a) {
  return {m.xx * a.x + m.xy * a.y + m.xz * a.z, m.xy * a.x + m.yy * a.y + m.yz * a.z,
          m.xz * a.x + m.yz * a.y + m.zz * a.z};
}

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

}  // namespace lodestone::lane
