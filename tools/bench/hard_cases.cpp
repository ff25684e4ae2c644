#include <array>
#include <cmath>

#include "tools/bench/hard_case.h"
#include "tools/bench/simbenchmark_cases.h"

namespace lodestone {

bool passes(const HardCaseRow& row) {
  return row.side == BoundSide::at_most ? row.value <= row.bound : row.value >= row.bound;
}

std::span<const HardCase> hard_cases() {
  static constexpr std::array kCases = {
      HardCase{"F1", measure_bouncing},
  };
  return kCases;
}

}  // namespace lodestone
