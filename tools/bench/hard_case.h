// The hard cases: set-ups on which physics engines are known to fail, each with its figures and the bounds that they must keep.
// A new case is a function, declared in the header of its group, and a line in hard_cases.cpp.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lodestone {

enum class BoundSide { at_most, at_least };

/// One figure of a case beside its bound.
struct HardCaseRow {
  std::string what;          ///< set-up and figure in a few words, ASCII
  double value = 0.0;
  double bound = 0.0;
  std::string unit = "";     ///< empty for a plain number
  BoundSide side = BoundSide::at_most;
  std::string odes_own = ""; ///< why ODE itself fails here and how the engine reports it; empty where a failure is ours
};

/// A value that is not a number fails.
bool passes(const HardCaseRow& row);

struct HardCaseSettings {
  bool quick = false;  ///< fewer steps, sizes or repeats of what takes more than a second or two; the same bounds
};

struct HardCase {
  std::string_view id;  ///< a letter and a number: F1
  std::vector<HardCaseRow> (*measure)(const HardCaseSettings&);
  bool alone = false;   ///< measures memory or time: nothing runs beside it
};

/// Every case, in the order of its listing.
std::span<const HardCase> hard_cases();

}  // namespace lodestone
