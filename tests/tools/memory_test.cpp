#include "tools/memory.h"

#include <gtest/gtest.h>

#include <cstring>

namespace lodestone {
namespace {

TEST(Memory, WhatIsTakenIsCountedUntilItIsGivenBack) {
  constexpr std::size_t kBytes = 64 << 20;
  const double heap = heap_bytes();
  ASSERT_GT(resident_bytes(), 0.0);
  {
    std::vector<char> taken(kBytes);
    std::memset(taken.data(), 1, kBytes);  // resident once it is written
    EXPECT_NEAR(heap_bytes() - heap, double(kBytes), 0.1 * kBytes);
    EXPECT_GT(resident_bytes(), 0.9 * kBytes);  // pages of other tests may serve again
    EXPECT_EQ(taken[kBytes / 2], 1);
  }
  EXPECT_LT(heap_bytes() - heap, 0.1 * kBytes);
}

}  // namespace
}  // namespace lodestone
