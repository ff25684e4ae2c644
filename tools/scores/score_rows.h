// Scores that are kept: what a method came to on which drops, and what it may come to at most
// (tests/baselines/scores.csv).
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/compare/fidelity.h"

namespace lodestone {

/// Of which drops a score is. `shape` is a SHAPE of the command line or a name of `compare shapes`,
/// `condition` one of `compare conditions` or `compare materials`, "usual" without any; `method` that of
/// `--methods`, the model for the statistical level.
struct ScoredDrops {
  std::string series, shape, condition;
  int trials = 0;
  std::string method;
  double step_s = 0.0;
  bool operator==(const ScoredDrops&) const = default;
};

struct ScoreRow {
  ScoredDrops drops;
  double score = 0.0, floor = 0.0;  ///< of the method; of the truth against itself
  double bound = 0.0;               ///< a greater score is a worse one
  std::string commit;               ///< of the program that measured it
};

/// The score, or the floor where that is greater, and as much again as the score's 95 % interval reaches up:
/// what other starts change is within it.
double bound_of(const ScoreWithInterval& score, double floor);

/// As csv_of gives them; lines that begin with # are comments. Throws InputError, headed by `name` and the
/// line, where a line is no row or says of the same drops again.
std::vector<ScoreRow> parse_scores(std::string_view name, std::string_view csv);

std::string csv_of(std::span<const ScoreRow> rows);

/// `kept`, in its order, with the rows of `measured` in place of those of the same drops; what is new follows
/// the last row of its series.
std::vector<ScoreRow> with_measured(std::vector<ScoreRow> kept, std::span<const ScoreRow> measured);

/// None where there is no row of these drops.
const ScoreRow* find_score(std::span<const ScoreRow> rows, const ScoredDrops& drops);

}  // namespace lodestone
