// Loops over dense arrays, compiled for several instruction sets and chosen at run time. The same operations
// in the same order without contraction or reassociation: the results are the same to the bit.
#pragma once

#include <cstdint>

namespace lodestone {

enum class Simd : std::uint8_t { portable, avx2, avx512 };

/// The widest that this processor has.
inline Simd find_simd() {
#if defined(__x86_64__) && defined(__GNUC__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl"))
    return Simd::avx512;
  if (__builtin_cpu_supports("avx2")) return Simd::avx2;
#endif
  return Simd::portable;
}

#if defined(__x86_64__) && defined(__GNUC__)
#define LODESTONE_INLINE [[gnu::always_inline]] inline

template <class Loop>
[[gnu::target("avx2")]] void run_avx2(const Loop& loop, std::int64_t begin, std::int64_t end) {
  loop(begin, end);
}
template <class Loop>
[[gnu::target("avx512f,avx512dq,avx512bw,avx512vl")]] void run_avx512(const Loop& loop, std::int64_t begin,
                                                                      std::int64_t end) {
  loop(begin, end);
}
#else
#define LODESTONE_INLINE inline
#endif

/// Calls `loop(begin, end)`, whose call operator is LODESTONE_INLINE, as compiled for `simd`.
template <class Loop>
void run_wide(Simd simd, const Loop& loop, std::int64_t begin, std::int64_t end) {
#if defined(__x86_64__) && defined(__GNUC__)
  if (simd == Simd::avx512) return run_avx512(loop, begin, end);
  if (simd == Simd::avx2) return run_avx2(loop, begin, end);
#endif
  loop(begin, end);
}

}  // namespace lodestone
