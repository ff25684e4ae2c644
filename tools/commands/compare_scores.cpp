#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "reference/error.h"
#include "reference/output_file.h"
#include "tools/commands.h"
#include "tools/interrupt.h"
#include "tools/pages/page_texts.h"
#include "tools/progress.h"
#include "tools/report/machine.h"
#include "tools/results.h"
#include "tools/scores/score_pages.h"
#include "tools/scores/score_series.h"
#include "tools/text_table.h"

namespace lodestone {
namespace {

struct ScoresArguments {
  std::vector<std::string> only;
  std::filesystem::path file, write, page;
  int threads = 0;
  ResultArguments results;
  Progress progress;  // while they are measured
};

std::string text_of_file(const std::filesystem::path& file, const char* expected) {
  if (const std::string fault = find_reading_fault(file); !fault.empty())
    throw_input_error(file.string(), fault, expected);
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

void write_file(const std::filesystem::path& file, const std::string& text) {
  OutputFile out(file, "the scores");
  out.write(text);
  out.close();
}

std::vector<ScoreRow> kept_scores(const ScoresArguments& arguments) {
  constexpr const char* kOwn = "scores.csv";
  if (arguments.file.empty()) return parse_scores(kOwn, find_page_text(kOwn).value());
  return parse_scores(arguments.file.string(), text_of_file(arguments.file, "a table of scores"));
}

std::vector<ScoreRow> measure_chosen(const ScoresArguments& arguments) {
  std::vector<ScoreRow> rows;
  until_interrupted([&] {  // the series that are whole
    for (const std::string& series : score_series_names()) {
      if (!arguments.only.empty() && std::ranges::count(arguments.only, series) == 0) continue;
      const auto of_series = measure_scores(series, program_commit(), arguments.threads, arguments.progress);
      rows.insert(rows.end(), of_series.begin(), of_series.end());
    }
  });
  return rows;
}

// A measured score beside the one that is kept.
struct Checked {
  const ScoreRow& now;
  const ScoreRow* kept;
  bool passes() const { return kept && now.score <= kept->bound; }
};

nlohmann::ordered_json json_of(const Checked& checked) {
  const ScoreRow& now = checked.now;
  const ScoreRow* const kept = checked.kept;
  const auto of_kept = [&](double ScoreRow::*value) {
    return or_null(kept ? std::optional(kept->*value) : std::nullopt);
  };
  return {{"series", now.drops.series},
          {"shape", now.drops.shape},
          {"condition", now.drops.condition},
          {"trials", now.drops.trials},
          {"method", now.drops.method},
          {"step_s", now.drops.step_s},
          {"score", now.score},
          {"floor", now.floor},
          {"kept_score", of_kept(&ScoreRow::score)},
          {"bound", of_kept(&ScoreRow::bound)},
          {"pass", checked.passes()}};
}

std::string text_of(const std::vector<Checked>& all) {
  TextTable table(
      {"series", "shape", "condition", "method", "step s", "score", "floor", "kept", "bound", ""});
  for (const Checked& checked : all) {
    const ScoredDrops& drops = checked.now.drops;
    const auto kept = [&](double ScoreRow::*value) {
      return checked.kept ? fmt::format("{:.3f}", checked.kept->*value) : std::string();
    };
    table.add_row({drops.series, drops.shape, drops.condition, drops.method,
                   fmt::format("{:g}", drops.step_s), fmt::format("{:.3f}", checked.now.score),
                   fmt::format("{:.3f}", checked.now.floor), kept(&ScoreRow::score), kept(&ScoreRow::bound),
                   checked.passes() ? ""
                   : checked.kept   ? "WORSE"
                                    : "NEW"});
  }
  return table.text();
}

ExitCode compare_scores(const ScoresArguments& arguments) {
  const std::vector<ScoreRow> kept = kept_scores(arguments);
  if (!arguments.page.empty()) {
    const PageOfScores page =
        with_score_tables(arguments.page.string(), text_of_file(arguments.page, "a page"), kept);
    write_file(arguments.page, page.text);
    print_results(arguments.results, {{"page", arguments.page.string()}, {"tables", page.tables}},
                  fmt::format("written {} ({} tables)\n", arguments.page.string(), page.tables));
    return ExitCode::done;
  }
  if (!arguments.write.empty())  // minutes of measuring come first
    if (const std::string fault = find_writing_fault(arguments.write); !fault.empty())
      throw_input_error(arguments.write.string(), fault, "a file that can be written");
  const std::vector<ScoreRow> measured = with_progress(arguments, measure_chosen);
  std::vector<Checked> all;
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const ScoreRow& row : measured) {
    all.push_back({row, find_score(kept, row.drops)});
    rows.push_back(json_of(all.back()));
  }
  print_results(arguments.results, {{"rows", rows}}, text_of(all));
  if (!arguments.write.empty()) {
    write_file(arguments.write, csv_of(with_measured(kept, measured)));
    return ExitCode::done;
  }
  return std::ranges::all_of(all, &Checked::passes) ? ExitCode::done : ExitCode::check_failed;
}

}  // namespace

void add_compare_scores_command(Command& compare) {
  auto [command, arguments] = compare.add<ScoresArguments>(
      "scores", "the scores that are kept, measured anew: each within its bound, or exit code 1",
      compare_scores);
  Option only = command.add_option("--only", arguments.only, "some of the series, with commas")
                    .several()
                    .one_of(score_series_names());
  command.add_option(
      "--file", arguments.file,
      "the table of scores; without, tests/baselines/scores.csv as the program was built with");
  Option write =
      command.add_option("--write", arguments.write,
                         "file for the table with what was measured, each with a new bound; checks nothing");
  command
      .add_option("--page", arguments.page,
                  "puts the tables of the scores that are kept into this page of Markdown; measures nothing")
      .excludes(only)
      .excludes(write);
  command.add_option("--threads", arguments.threads, "0: all cores").within(0, 4096);
  add_json_argument(command, arguments.results);
}

}  // namespace lodestone
