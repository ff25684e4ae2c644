// Vectors and rotations of floats for loops over bodies: without branches, and inlined, so that a compiler
// can make vector instructions of them.
#pragma once

#include "lod/simd/wide_loop.h"

namespace lodestone::lane {

struct F3 {
  float x, y, z;
};

LODESTONE_INLINE float square_root(float x) { return __builtin_sqrtf(x); }
LODESTONE_INLINE float absolute(float x) { return __builtin_fabsf(x); }
LODESTONE_INLINE float least(float a, float b) { return a < b ? a : b; }
/// a where the mask is −1, b where it is 0.
LODESTONE_INLINE float select(int mask, float a, float b) {
  return __builtin_bit_cast(float,
                            (__builtin_bit_cast(int, a) & mask) | (__builtin_bit_cast(int, b) & ~mask));
}

LODESTONE_INLINE double select(std::int64_t mask, double a, double b) {
  return __builtin_bit_cast(
      double, (__builtin_bit_cast(std::int64_t, a) & mask) | (__builtin_bit_cast(std::int64_t, b) & ~mask));
}

/// `which` ? a : b, by masks: compilers make branches of nested conditionals, and no vectors of branches.
LODESTONE_INLINE int choose(bool which, int a, int b) {
  const int mask = -int(which);
  return (a & mask) | (b & ~mask);
}
LODESTONE_INLINE float choose(bool which, float a, float b) {
  return __builtin_bit_cast(float, choose(which, __builtin_bit_cast(int, a), __builtin_bit_cast(int, b)));
}
LODESTONE_INLINE F3 choose(bool which, F3 a, F3 b) {
  return {choose(which, a.x, b.x), choose(which, a.y, b.y), choose(which, a.z, b.z)};
}
LODESTONE_INLINE float most(float a, float b) { return a > b ? a : b; }

LODESTONE_INLINE F3 operator+(F3 a, F3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
LODESTONE_INLINE F3 operator-(F3 a, F3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
LODESTONE_INLINE F3 operator*(float s, F3 a) { return {s * a.x, s * a.y, s * a.z}; }
LODESTONE_INLINE float dot(F3 a, F3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
LODESTONE_INLINE F3 cross(F3 a, F3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
LODESTONE_INLINE float length(F3 a) { return square_root(dot(a, a)); }

/// A rotation as a unit quaternion.
struct Turn {
  float w;
  F3 v;
};

LODESTONE_INLINE F3 turned(const Turn& q, F3 a) {
  const F3 t = 2.0f * cross(q.v, a);
  return a + q.w * t + cross(q.v, t);
}
LODESTONE_INLINE Turn back(const Turn& q) { return {q.w, {-q.v.x, -q.v.y, -q.v.z}}; }
LODESTONE_INLINE Turn product(const Turn& a, const Turn& b) {
  return {a.w * b.w - a.v.x * b.v.x - a.v.y * b.v.y - a.v.z * b.v.z,
          {a.w * b.v.x + a.v.x * b.w + a.v.y * b.v.z - a.v.z * b.v.y,
           a.w * b.v.y - a.v.x * b.v.z + a.v.y * b.w + a.v.z * b.v.x,
           a.w * b.v.z + a.v.x * b.v.y - a.v.y * b.v.x + a.v.z * b.w}};
}

/// Symmetric matrices in dense arrays, one a kind of body.
struct Tensors {
  const float *xx, *yy, *zz, *xy, *xz, *yz;
};

/// R M Rᵀ a: with M the inverse inertia and a the spin, the angular velocity.
LODESTONE_INLINE F3 in_world(const Tensors& m, int kind, const Turn& q, F3 a) {
  const F3 b = turned(back(q), a);
  return turned(q, {m.xx[kind] * b.x + m.xy[kind] * b.y + m.xz[kind] * b.z,
                    m.xy[kind] * b.x + m.yy[kind] * b.y + m.yz[kind] * b.z,
                    m.xz[kind] * b.x + m.yz[kind] * b.y + m.zz[kind] * b.z});
}

/// arctan(y/x) for y, x ≥ 0 (Abramowitz and Stegun, Handbook of mathematical functions, 4.4.49: error 2e-8,
/// and rounding); 0 where both are.
LODESTONE_INLINE float arc_tangent(float y, float x) {
  const float small = least(y, x), large = most(y, x);
  const float t = small / most(large, 1e-30f), s = t * t;
  float sum = 0.0028662257f;
  sum = sum * s - 0.0161657367f;
  sum = sum * s + 0.0429096138f;
  sum = sum * s - 0.0752896400f;
  sum = sum * s + 0.1065626393f;
  sum = sum * s - 0.1420889944f;
  sum = sum * s + 0.1999355085f;
  sum = sum * s - 0.3333314528f;
  sum = (sum * s + 1.0f) * t;
  return choose(y > x, 1.57079633f - sum, sum);
}

/// The rotation by `omega` for `time`, from the series of sine and cosine; whole turns of a fast spin are
/// left out beforehand.
LODESTONE_INLINE Turn turn_by(F3 omega, float time) {
  constexpr float kPi = 3.14159265f;
  const float rate = length(omega), whole = 0.5f * time * rate;
  const float turns = float(int(least(whole, 1e6f) * (1.0f / kPi))),
              half = choose(whole < 1e6f, whole - kPi * turns, 0.0f);
  const float z = half * half;
  float s = 1.6059044e-10f, c = 2.0876757e-9f;  // 1/13!, 1/12!
  c = c * z - 2.7557319e-7f;
  s = s * z - 2.5052108e-8f;
  c = c * z + 2.4801587e-5f;
  s = s * z + 2.7557319e-6f;
  c = c * z - 1.3888889e-3f;
  s = s * z - 1.9841270e-4f;
  c = c * z + 4.1666668e-2f;
  s = s * z + 8.3333333e-3f;
  c = c * z - 0.5f;
  s = s * z - 0.16666667f;
  c = c * z + 1.0f;
  s = (s * z + 1.0f) * half;
  const float along = s / most(rate, 1e-12f);
  return {c, along * omega};
}

}  // namespace lodestone::lane
