// Measuring hard cases, several at a time.
#pragma once

#include "signature/signature_source.h"
#include "tools/hard_cases/hard_case.h"

namespace lodestone {

struct HardCaseRunSettings {
  HardCaseSettings cases;
  std::vector<std::string> only;  ///< ids; empty: all
  int threads = 0;                ///< 0: all cores
  Progress progress;
};

struct HardCaseResult {
  std::string id;
  std::vector<HardCaseRow> rows;
};

/// In the order of hard_cases(), whatever the threads.
std::vector<HardCaseResult> run_hard_cases(const HardCaseRunSettings& settings);

}  // namespace lodestone
