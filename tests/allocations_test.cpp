#include "tests/allocations.h"

#include <gtest/gtest.h>
#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <memory>
#include <new>

#include "reference/sanitizers.h"

namespace {

std::atomic<std::int64_t> calls = 0, held = 0;

[[maybe_unused]] void* counted(void* memory) {
  if (!memory) throw std::bad_alloc();
  ++calls;
  held += std::int64_t(malloc_usable_size(memory));
  return memory;
}

}  // namespace

#if !LODESTONE_ADDRESS_SANITIZER && !LODESTONE_THREAD_SANITIZER
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"  // where one is inlined and the other is not
void* operator new(std::size_t size) { return counted(std::malloc(size ? size : 1)); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  const auto to = std::size_t(alignment);
  return counted(std::aligned_alloc(to, (size + to - 1) / to * to));
}
void operator delete(void* memory) noexcept {
  held -= std::int64_t(malloc_usable_size(memory));
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept { operator delete(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { operator delete(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { operator delete(memory); }
#endif

namespace lodestone {

std::int64_t allocations() { return calls; }
std::int64_t bytes_held() { return held; }

namespace {

#if !LODESTONE_ADDRESS_SANITIZER && !LODESTONE_THREAD_SANITIZER
TEST(Allocations, AreCountedAndWeighed) {
  struct alignas(64) Wide {
    char bytes[640];
  };
  const std::int64_t calls_before = allocations(), held_before = bytes_held();
  auto wide = std::make_unique<Wide>();
  EXPECT_EQ(allocations() - calls_before, 1);
  EXPECT_GE(bytes_held() - held_before, 640);
  wide.reset();
  EXPECT_EQ(bytes_held(), held_before);
}
#endif

}  // namespace
}  // namespace lodestone
