// The list of all cases.
#include <algorithm>
#include <charconv>
#include <utility>

#include "tools/hard_cases/hard_case.h"

namespace lodestone {
namespace {

constexpr std::span<const HardCase> (*kGroups[])() = {
    simbenchmark_cases, single_body_cases, heap_cases,   contact_cases, extreme_cases, engine_cases,
    odd_hit_cases,      response_cases,    flight_cases, rest_cases,    crowd_cases};

/// F2 before F10, all F before S1.
std::pair<char, int> order_of(const HardCase& one) {
  int number = 0;
  std::from_chars(one.id.data() + 1, one.id.data() + one.id.size(), number);
  return {one.id[0], number};
}

std::vector<HardCase> list_cases() {
  std::vector<HardCase> all;
  for (const auto group : kGroups) all.insert(all.end(), group().begin(), group().end());
  std::ranges::sort(all, {}, order_of);
  return all;
}

}  // namespace

bool passes(const HardCaseRow& row) {
  return row.side == BoundSide::at_most ? row.value <= row.bound : row.value >= row.bound;
}

std::span<const HardCase> hard_cases() {
  static const std::vector<HardCase> kCases = list_cases();
  return kCases;
}

}  // namespace lodestone
