// Which balls of a run in memory are near one ball: as many at a time as the processor has lanes for, and
// written without a branch, as which are near is hard to foresee.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "lod/simd/wide_loop.h"

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>
#endif

namespace lodestone {

/// Pairs of balls, in arrays that only grow.
class BallPairs {
 public:
  std::int64_t size() const { return size_; }
  std::uint32_t first(std::int64_t i) const { return first_[std::size_t(i)]; }
  std::uint32_t second(std::int64_t i) const { return second_[std::size_t(i)]; }
  void clear() { size_ = 0; }
  void add(std::uint32_t first, std::uint32_t second) {
    make_room(1);
    first_[std::size_t(size_)] = first, second_[std::size_t(size_++)] = second;
  }
  /// Drops those for which keep(first, second) is false.
  template <class Keep>
  void filter(const Keep& keep) {
    std::int64_t kept = 0;
    for (std::int64_t i = 0; i < size_; ++i)
      if (keep(first(i), second(i)))
        first_[std::size_t(kept)] = first(i), second_[std::size_t(kept++)] = second(i);
    size_ = kept;
  }

  static constexpr std::int64_t kOverrun = 16;  ///< elements beyond the end that may be written
  void make_room(std::int64_t count) {
    const auto needed = std::size_t(size_ + count + kOverrun);
    if (first_.size() < needed) first_.resize(2 * needed), second_.resize(2 * needed);
  }
  std::uint32_t* end_first() { return first_.data() + size_; }
  std::uint32_t* end_second() { return second_.data() + size_; }
  void grow(std::int64_t count) { size_ += count; }

 private:
  std::vector<std::uint32_t> first_, second_;
  std::int64_t size_ = 0;
};

struct BallArrays {
  const float *x, *y, *z, *reach;  // m
  const std::uint32_t* index;      // what they are called
};
struct NearBall {
  float x, y, z, reach;  // m
  std::uint32_t index;
};

/// Writes the pairs of `ball` with those in [begin, end) whose reach meets its own, in order, and returns how
/// many. Room for kOverrun more must follow.
template <Simd>
std::uint32_t find_near_balls(const BallArrays& balls, const NearBall& ball, std::uint32_t begin,
                              std::uint32_t end, std::uint32_t* first, std::uint32_t* second);

template <>
inline std::uint32_t find_near_balls<Simd::portable>(const BallArrays& balls, const NearBall& ball,
                                                     std::uint32_t begin, std::uint32_t end,
                                                     std::uint32_t* first, std::uint32_t* second) {
  std::uint32_t count = 0;
  for (std::uint32_t other = begin; other < end; ++other) {
    const float dx = balls.x[other] - ball.x, dy = balls.y[other] - ball.y, dz = balls.z[other] - ball.z,
                limit = balls.reach[other] + ball.reach;
    first[count] = ball.index, second[count] = balls.index[other];
    count += dx * dx + dy * dy + dz * dz < limit * limit;
  }
  return count;
}

#if defined(__x86_64__) && defined(__GNUC__)
template <>
[[gnu::target("avx2")]] inline std::uint32_t find_near_balls<Simd::avx2>(
    const BallArrays& balls, const NearBall& ball, std::uint32_t begin, std::uint32_t end,
    std::uint32_t* first, std::uint32_t* second) {
  const __m256 x = _mm256_set1_ps(ball.x), y = _mm256_set1_ps(ball.y), z = _mm256_set1_ps(ball.z),
               reach = _mm256_set1_ps(ball.reach);
  std::uint32_t count = 0, other = begin;
  for (; other + 8 <= end; other += 8) {
    const __m256 dx = _mm256_sub_ps(_mm256_loadu_ps(balls.x + other), x),
                 dy = _mm256_sub_ps(_mm256_loadu_ps(balls.y + other), y);
    const __m256 dz = _mm256_sub_ps(_mm256_loadu_ps(balls.z + other), z),
                 limit = _mm256_add_ps(_mm256_loadu_ps(balls.reach + other), reach);
    const __m256 square =
        _mm256_add_ps(_mm256_add_ps(_mm256_mul_ps(dx, dx), _mm256_mul_ps(dy, dy)), _mm256_mul_ps(dz, dz));
    auto hits =
        std::uint32_t(_mm256_movemask_ps(_mm256_cmp_ps(square, _mm256_mul_ps(limit, limit), _CMP_LT_OQ)));
    for (; hits; hits &= hits - 1)
      first[count] = ball.index, second[count++] = balls.index[other + std::uint32_t(std::countr_zero(hits))];
  }
  return count + find_near_balls<Simd::portable>(balls, ball, other, end, first + count, second + count);
}

template <>
[[gnu::target("avx512f,avx512dq,avx512bw,avx512vl")]] inline std::uint32_t find_near_balls<Simd::avx512>(
    const BallArrays& balls, const NearBall& ball, std::uint32_t begin, std::uint32_t end,
    std::uint32_t* first, std::uint32_t* second) {
  const __m512 x = _mm512_set1_ps(ball.x), y = _mm512_set1_ps(ball.y), z = _mm512_set1_ps(ball.z),
               reach = _mm512_set1_ps(ball.reach);
  const __m512i own = _mm512_set1_epi32(int(ball.index));
  std::uint32_t count = 0;
  for (std::uint32_t other = begin; other < end; other += 16) {
    const auto lanes = __mmask16(end - other >= 16 ? 0xffffu : (1u << (end - other)) - 1);
    const __m512 dx = _mm512_sub_ps(_mm512_maskz_loadu_ps(lanes, balls.x + other), x),
                 dy = _mm512_sub_ps(_mm512_maskz_loadu_ps(lanes, balls.y + other), y);
    const __m512 dz = _mm512_sub_ps(_mm512_maskz_loadu_ps(lanes, balls.z + other), z),
                 limit = _mm512_add_ps(_mm512_maskz_loadu_ps(lanes, balls.reach + other), reach);
    const __m512 square =
        _mm512_add_ps(_mm512_add_ps(_mm512_mul_ps(dx, dx), _mm512_mul_ps(dy, dy)), _mm512_mul_ps(dz, dz));
    const __mmask16 hits = _mm512_mask_cmp_ps_mask(lanes, square, _mm512_mul_ps(limit, limit), _CMP_LT_OQ);
    _mm512_storeu_si512(first + count, own);
    _mm512_storeu_si512(second + count, _mm512_maskz_compress_epi32(
                                            hits, _mm512_maskz_loadu_epi32(lanes, balls.index + other)));
    count += std::uint32_t(std::popcount(std::uint32_t(hits)));
  }
  return count;
}
#endif

}  // namespace lodestone
