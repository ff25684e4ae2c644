// The hard cases: set-ups on which physics engines are known to fail, each with its figures and the bounds
// that they must keep. A new case is a function in the file of its group and a line in the table at that
// file's end.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lodestone {

enum class BoundSide { at_most, at_least };

/// One figure of a case beside its bound.
struct HardCaseRow {
  std::string what;  ///< set-up and figure in a few words, ASCII
  double value = 0.0;
  double bound = 0.0;
  std::string unit = "";  ///< empty for a plain number
  BoundSide side = BoundSide::at_most;
  /// Why ODE itself fails here and how the engine reports it; empty where a failure is ours.
  std::string odes_own = "";
};

/// A value that is not a number fails.
bool passes(const HardCaseRow& row);

struct HardCaseSettings {
  /// Fewer steps, sizes or repeats of what takes more than a second or two; the same bounds.
  bool quick = false;
};

struct HardCase {
  std::string_view id;  ///< a letter and a number: F1
  std::vector<HardCaseRow> (*measure)(const HardCaseSettings&);
  bool alone = false;  ///< measures memory or time: nothing runs beside it
};

/// The groups, each the table of a file of that name.
std::span<const HardCase> simbenchmark_cases();
std::span<const HardCase> single_body_cases();
std::span<const HardCase> heap_cases();
std::span<const HardCase> contact_cases();
std::span<const HardCase> extreme_cases();
std::span<const HardCase> engine_cases();
std::span<const HardCase> odd_hit_cases();
std::span<const HardCase> response_cases();
std::span<const HardCase> flight_cases();
std::span<const HardCase> rest_cases();
std::span<const HardCase> crowd_cases();

/// The cases of all groups, by letter and number.
std::span<const HardCase> hard_cases();

}  // namespace lodestone
