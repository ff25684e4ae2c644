// Which balls of a run in memory are near one ball: as many at a time as the processor has lanes for.
#pragma once

#include <bit>
#include <cstdint>

#include "lod/tables/wide_loop.h"

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>
#endif

namespace lodestone {

struct BallArrays {
  const float *x, *y, *z, *reach;  // m
};
struct NearBall {
  float x, y, z, reach;  // m
};

inline std::uint32_t find_near_balls_one_by_one(const BallArrays& balls, const NearBall& ball, std::uint32_t begin, std::uint32_t end, std::uint32_t* near) {
  std::uint32_t count = 0;
  for (std::uint32_t other = begin; other < end; ++other) {  // without branches: which are near is hard to foresee
    const float dx = balls.x[other] - ball.x, dy = balls.y[other] - ball.y, dz = balls.z[other] - ball.z, limit = balls.reach[other] + ball.reach;
    near[count] = other;
    count += dx * dx + dy * dy + dz * dz < limit * limit;
  }
  return count;
}

#if defined(__x86_64__) && defined(__GNUC__)
[[gnu::target("avx2")]] inline std::uint32_t find_near_balls_avx2(const BallArrays& balls, const NearBall& ball, std::uint32_t begin, std::uint32_t end,
                                                                  std::uint32_t* near) {
  const __m256 x = _mm256_set1_ps(ball.x), y = _mm256_set1_ps(ball.y), z = _mm256_set1_ps(ball.z), reach = _mm256_set1_ps(ball.reach);
  std::uint32_t count = 0, other = begin;
  for (; other + 8 <= end; other += 8) {
    const __m256 dx = _mm256_sub_ps(_mm256_loadu_ps(balls.x + other), x), dy = _mm256_sub_ps(_mm256_loadu_ps(balls.y + other), y);
    const __m256 dz = _mm256_sub_ps(_mm256_loadu_ps(balls.z + other), z), limit = _mm256_add_ps(_mm256_loadu_ps(balls.reach + other), reach);
    const __m256 square = _mm256_add_ps(_mm256_add_ps(_mm256_mul_ps(dx, dx), _mm256_mul_ps(dy, dy)), _mm256_mul_ps(dz, dz));
    auto hits = std::uint32_t(_mm256_movemask_ps(_mm256_cmp_ps(square, _mm256_mul_ps(limit, limit), _CMP_LT_OQ)));
    for (; hits; hits &= hits - 1) near[count++] = other + std::uint32_t(std::countr_zero(hits));
  }
  return count + find_near_balls_one_by_one(balls, ball, other, end, near + count);
}

[[gnu::target("avx512f,avx512dq,avx512bw,avx512vl")]] inline std::uint32_t find_near_balls_avx512(const BallArrays& balls, const NearBall& ball, std::uint32_t begin,
                                                                                                 std::uint32_t end, std::uint32_t* near) {
  const __m512 x = _mm512_set1_ps(ball.x), y = _mm512_set1_ps(ball.y), z = _mm512_set1_ps(ball.z), reach = _mm512_set1_ps(ball.reach);
  std::uint32_t count = 0;
  for (std::uint32_t other = begin; other < end; other += 16) {
    const auto lanes = __mmask16(end - other >= 16 ? 0xffffu : (1u << (end - other)) - 1);
    const __m512 dx = _mm512_sub_ps(_mm512_maskz_loadu_ps(lanes, balls.x + other), x), dy = _mm512_sub_ps(_mm512_maskz_loadu_ps(lanes, balls.y + other), y);
    const __m512 dz = _mm512_sub_ps(_mm512_maskz_loadu_ps(lanes, balls.z + other), z), limit = _mm512_add_ps(_mm512_maskz_loadu_ps(lanes, balls.reach + other), reach);
    const __m512 square = _mm512_add_ps(_mm512_add_ps(_mm512_mul_ps(dx, dx), _mm512_mul_ps(dy, dy)), _mm512_mul_ps(dz, dz));
    std::uint32_t hits = _mm512_mask_cmp_ps_mask(lanes, square, _mm512_mul_ps(limit, limit), _CMP_LT_OQ);
    for (; hits; hits &= hits - 1) near[count++] = other + std::uint32_t(std::countr_zero(hits));
  }
  return count;
}
#endif

/// Writes the indices in [begin, end) of balls whose reach meets that of `ball` to `near`, in order, and returns how many; `near` has room for as many as there
/// are and one more.
inline std::uint32_t find_near_balls(const BallArrays& balls, const NearBall& ball, std::uint32_t begin, std::uint32_t end, Simd simd, std::uint32_t* near) {
#if defined(__x86_64__) && defined(__GNUC__)
  if (simd == Simd::avx512) return find_near_balls_avx512(balls, ball, begin, end, near);
  if (simd == Simd::avx2) return find_near_balls_avx2(balls, ball, begin, end, near);
#endif
  return find_near_balls_one_by_one(balls, ball, begin, end, near);
}

}  // namespace lodestone
