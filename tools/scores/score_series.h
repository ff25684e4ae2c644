// The drops whose scores are kept, in series that are measured together.
#pragma once

#include <string>
#include <vector>

#include "signature/signature_source.h"
#include "tools/scores/score_rows.h"

namespace lodestone {

/// `quick`: what takes seconds; `drops`: box, L and bunny at four steps; `shapes`: what nothing was tuned on;
/// `conditions`, `materials`: those of `compare conditions` and `compare materials`.
std::vector<std::string> score_series_names();

/// The rows of a series, with `commit` in each. Throws Interrupted before it is whole.
std::vector<ScoreRow> measure_scores(const std::string& series, const std::string& commit, int threads,
                                     const Progress& progress);

}  // namespace lodestone
