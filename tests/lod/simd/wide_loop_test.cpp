#include "lod/simd/wide_loop.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "reference/random.h"

namespace lodestone {
namespace {

struct Loop {
  const float *a, *b;
  float* out;
  LODESTONE_INLINE void operator()(std::int64_t begin, std::int64_t end) const {
    for (std::int64_t i = begin; i < end; ++i) {
      const float product = a[i] * b[i] + 0.3f;  // one rounding more or less would show
      out[i] = product > 0.0f ? std::sqrt(product) : product / (1.0f + a[i] * a[i]);
    }
  }
};

std::vector<Simd> those_here() {
  std::vector<Simd> widths = {Simd::portable};
  if (find_simd() >= Simd::avx2) widths.push_back(Simd::avx2);
  if (find_simd() >= Simd::avx512) widths.push_back(Simd::avx512);
  return widths;
}

TEST(WideLoop, GivesTheSameBitsAtEveryWidthAndForEveryPiece) {
  constexpr int kCount = 203;
  RandomStream random(8, 0, 0);
  std::vector<float> a, b, expected(kCount);
  for (int i = 0; i < kCount; ++i)
    a.push_back(float(random.uniform(-2, 2))), b.push_back(float(random.uniform(-2, 2)));
  for (int i = 0; i < kCount; ++i) Loop{a.data(), b.data(), expected.data()}(i, i + 1);  // one by one
  for (const Simd simd : those_here())
    for (const int piece : {1, 7, 16, 100, kCount}) {
      std::vector<float> out(kCount, -1e9f);
      for (int begin = 0; begin < kCount; begin += piece)
        run_wide(simd, Loop{a.data(), b.data(), out.data()}, begin, std::min(begin + piece, kCount));
      EXPECT_EQ(std::memcmp(out.data(), expected.data(), sizeof(float) * kCount), 0)
          << int(simd) << ' ' << piece;
    }
}

TEST(WideLoop, TouchesNothingOutsideItsRange) {
  const std::vector<float> a(64, 1.0f), b(64, 2.0f);
  for (const Simd simd : those_here())
    for (const auto& [begin, end] : {std::pair(0, 0), std::pair(5, 5), std::pair(3, 30), std::pair(60, 64)}) {
      std::vector<float> out(64, -7.0f);
      run_wide(simd, Loop{a.data(), b.data(), out.data()}, begin, end);
      for (int i = 0; i < 64; ++i) EXPECT_EQ(out[std::size_t(i)] != -7.0f, i >= begin && i < end) << i;
    }
}

}  // namespace
}  // namespace lodestone
