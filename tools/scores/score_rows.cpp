#include "tools/scores/score_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "reference/error.h"
#include "tools/report/report_table.h"

namespace lodestone {
namespace {

constexpr std::string_view kKeys = "series,shape,condition,trials,method,step_s,score,floor,bound,commit";
constexpr std::size_t kCells = 10;
// Of scores.csv as it is written anew.
constexpr std::string_view kAbout =
    "# Scores of drops against converged ODE, and what each may come to at most (its score, or the noise "
    "floor, and the upper half of its 95 % interval).\n"
    "# command: build/lodestone compare scores; measured anew: build/lodestone compare scores --write "
    "tests/baselines/scores.csv\n";

// SHAPEs have commas.
std::string quoted(const std::string& text) { return '"' + text + '"'; }

template <class Number>
Number number_of(const std::string& where, const std::string& text) {
  Number number{};
  const char* end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, number);
  if (read.ec != std::errc() || read.ptr != end || !(number >= Number(0)) || !std::isfinite(double(number)))
    throw InputError(fmt::format("{}: found \"{}\", expected a number from 0", where, text));
  return number;
}

ScoreRow row_of(const std::string& where, std::string_view line) {
  const std::vector<CsvCell> cells = cells_of(line);
  if (cells.size() != kCells)
    throw InputError(fmt::format("{}: found {} cells, expected {}: {}", where, cells.size(), kCells, kKeys));
  return {{cells[0].text, cells[1].text, cells[2].text, number_of<int>(where, cells[3].text), cells[4].text,
           number_of<double>(where, cells[5].text)},
          number_of<double>(where, cells[6].text),
          number_of<double>(where, cells[7].text),
          number_of<double>(where, cells[8].text),
          cells[9].text};
}

}  // namespace

double bound_of(const ScoreWithInterval& score, double floor) {
  return std::max(score.value.score, floor) + std::max(0.0, score.interval[1] - score.value.score);
}

std::vector<ScoreRow> parse_scores(std::string_view name, std::string_view csv) {
  std::vector<ScoreRow> rows;
  bool has_keys = false;
  for (int number = 1; !csv.empty(); ++number) {
    const std::string_view line = csv.substr(0, csv.find('\n'));
    csv.remove_prefix(std::min(csv.size(), line.size() + 1));
    if (line.starts_with('#')) continue;
    const std::string where = fmt::format("{}: line {}", name, number);
    if (!has_keys) {
      if (line != kKeys) throw InputError(fmt::format("{}: found \"{}\", expected {}", where, line, kKeys));
      has_keys = true;
      continue;
    }
    ScoreRow row = row_of(where, line);
    if (find_score(rows, row.drops))
      throw InputError(fmt::format("{}: found the drops of a line above again, expected each once", where));
    rows.push_back(std::move(row));
  }
  if (!has_keys) throw InputError(fmt::format("{}: found no table, expected {}", name, kKeys));
  return rows;
}

std::string csv_of(std::span<const ScoreRow> rows) {
  std::string csv = fmt::format("{}{}\n", kAbout, kKeys);
  for (const auto& [drops, score, floor, bound, commit] : rows)
    csv += fmt::format("{},{},{},{},{},{:.6f},{:.4f},{:.4f},{:.4f},{}\n", drops.series, quoted(drops.shape),
                       quoted(drops.condition), drops.trials, drops.method, drops.step_s, score, floor, bound,
                       commit);
  return csv;
}

std::vector<ScoreRow> with_measured(std::vector<ScoreRow> kept, std::span<const ScoreRow> measured) {
  for (const ScoreRow& row : measured) {
    const auto same = std::ranges::find(kept, row.drops, &ScoreRow::drops);
    if (same != kept.end()) {
      *same = row;
      continue;
    }
    const auto last = std::find_if(kept.rbegin(), kept.rend(), [&](const ScoreRow& other) {
      return other.drops.series == row.drops.series;
    });
    kept.insert(last == kept.rend() ? kept.end() : last.base(), row);
  }
  return kept;
}

const ScoreRow* find_score(std::span<const ScoreRow> rows, const ScoredDrops& drops) {
  const auto found = std::ranges::find(rows, drops, &ScoreRow::drops);
  return found == rows.end() ? nullptr : &*found;
}

}  // namespace lodestone
