// What fuzz targets share. Each target is a file of its own with LLVMFuzzerTestOneInput, which libFuzzer
// calls (tools/fuzz) or replay.cpp.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <span>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace lodestone::fuzz {

/// Aborts, which a fuzzer and ctest take for a fault, where what must hold does not.
inline void require(bool holds, const std::string& what) {
  if (holds) return;
  std::fprintf(stderr, "fuzz: %s\n", what.c_str());
  std::abort();
}

/// An input taken piece by piece; zeros once it has ended.
class FuzzInput {
 public:
  FuzzInput(const std::uint8_t* data, std::size_t size) : rest_(data, size) {}

  bool ended() const { return rest_.empty(); }
  std::span<const std::uint8_t> rest() const { return rest_; }

  std::uint8_t byte() {
    if (rest_.empty()) return 0;
    const std::uint8_t value = rest_.front();
    rest_ = rest_.subspan(1);
    return value;
  }

  /// 0 … count − 1.
  int choice(int count) { return byte() % count; }

  /// Of 65,536 in [low, high].
  double real(double low, double high) {
    const int high_byte = byte(), low_byte = byte();
    return low + (high - low) * (256 * high_byte + low_byte) / 65535.0;
  }

  /// Any double at all; every other one is a special one.
  double any_real() {
    constexpr double kSpecial[] = {0.0,
                                   -0.0,
                                   1.0,
                                   -1.0,
                                   std::numeric_limits<double>::quiet_NaN(),
                                   std::numeric_limits<double>::infinity(),
                                   -std::numeric_limits<double>::infinity(),
                                   std::numeric_limits<double>::max(),
                                   std::numeric_limits<double>::denorm_min(),
                                   1e-30,
                                   1e30,
                                   1e200};
    if (const int which = choice(24); which < 12) return kSpecial[which];
    std::uint8_t bytes[8];
    for (std::uint8_t& one : bytes) one = byte();
    double value = 0.0;
    std::memcpy(&value, bytes, sizeof value);
    return value;
  }

 private:
  std::span<const std::uint8_t> rest_;
};

}  // namespace lodestone::fuzz
