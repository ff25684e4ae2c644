// Scores as tables in pages of Markdown: between a line `<!-- scores: NAME -->` and `<!-- end of scores -->`.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/scores/score_rows.h"

namespace lodestone {

struct PageOfScores {
  std::string text;
  int tables = 0;
};

/// `page` with each table that it asks for made of `rows`, with the commits of its figures under it: `drops`,
/// of every method of tests/baselines/scores_*.csv at four steps; `shapes`, `conditions`, `ground` and
/// `materials`. Of a figure that is not there the cell is empty. Throws InputError, headed by `name` and the
/// line, for a table that there is not, or that has no end, and for a page that asks for none.
PageOfScores with_score_tables(std::string_view name, std::string_view page,
                               const std::vector<ScoreRow>& rows);

}  // namespace lodestone
