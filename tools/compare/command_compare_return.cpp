#include "tools/compare/command_compare_return.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "tools/compare/comparison_arguments.h"
#include "tools/compare/return_comparison.h"
#include "tools/progress.h"
#include "tools/results.h"
#include "tools/shape_arguments.h"
#include "tools/signature_arguments.h"

namespace lodestone {
namespace {

struct Arguments {
  ShapeArguments shape;
  SignatureArguments signature;
  ReturnSettings returning;
  std::string rung = "support";
  bool json = false;
};

nlohmann::ordered_json json_of(const Arguments& arguments, const std::string& shape,
                               const ReturnComparison& found) {
  nlohmann::ordered_json json{{"shape", shape},
                              {"runs", found.runs},
                              {"rung", arguments.rung},
                              {"leave_s", arguments.returning.leave_s},
                              {"away_s", arguments.returning.away_s},
                              {"score", found.score},
                              {"score_floor", found.score_floor},
                              {"mean_rung_changes", found.mean_rung_changes},
                              {"full_at_end", found.all_full_again}};
  for (const ReturnMeasure& m : found.measures) {
    nlohmann::ordered_json row{{"name", m.name},
                               {"mean_full", m.mean_full},
                               {"mean_returned", m.mean_returned},
                               {"distance", m.distance},
                               {"floor", m.floor}};
    if (m.critical > 0)
      row["critical_5_percent"] = m.critical, row["w1_over_deviation"] = m.w1_over_deviation,
      row["w1_floor"] = m.w1_floor;
    json["measures"].push_back(row);
  }
  return json;
}

std::string text_of(const Arguments& arguments, const std::string& shape, const ReturnComparison& found) {
  std::string text = fmt::format(
      "{}: {} runs in which the viewpoint leaves at {:g} s for {:g} s ({} meanwhile), against {} that are "
      "full all the time\n",
      shape, found.runs, arguments.returning.leave_s, arguments.returning.away_s, arguments.rung, found.runs);
  text +=
      fmt::format("{:.1f} changes of rung on average, {:.0f} % full at the end; score {:.3f}, floor {:.3f}\n",
                  found.mean_rung_changes, 100 * found.all_full_again, found.score, found.score_floor);
  text += fmt::format("{:<16} {:>10} {:>10} {:>8} {:>8} {:>8} {:>8} {:>8}\n", "", "full", "returned", "KS",
                      "floor", "5 %", "W1/dev", "floor");
  for (const ReturnMeasure& m : found.measures) {
    text += fmt::format("{:<16} {:>10.3f} {:>10.3f} {:>8.3f} {:>8.3f}", m.name, m.mean_full, m.mean_returned,
                        m.distance, m.floor);
    text += m.critical > 0
                ? fmt::format(" {:>8.3f} {:>8.3f} {:>8.3f}\n", m.critical, m.w1_over_deviation, m.w1_floor)
                : "\n";
  }
  return text +
         "KS: Kolmogorov-Smirnov distance, of which two ensembles alike exceed \"5 %\" in 5 % of cases; of "
         "the rest pose: total variation, with the part at rest as its mean\n";
}

void run_comparison(const Arguments& arguments) {
  const DropJob job{.shape = make_shape_from_arguments(arguments.shape),
                    .conditions = {},
                    .material = arguments.shape.material};
  ReturnSettings settings = arguments.returning;
  settings.measuring = arguments.signature.measuring();
  settings.away = arguments.rung == "support" ? StatisticalModel::support : StatisticalModel::tables;
  settings.published = arguments.rung != "tables_on_hull";
  ReturnComparison found;
  {
    ProgressLine line;
    settings.progress = line.function();
    found = compare_return(job, settings);
  }
  if (arguments.json)
    print_json(json_of(arguments, job.shape->name, found));
  else
    fmt::print("{}", text_of(arguments, job.shape->name, found));
}

}  // namespace

void add_compare_return_command(CLI::App& compare, ExitCode& exit_code) {
  CLI::App* command = compare.add_subcommand(
      "return", "a body that leaves the view and returns, against one that is full all the time");
  const auto arguments = std::make_shared<Arguments>();
  ReturnSettings& returning = arguments->returning;
  add_shape_arguments(*command, arguments->shape);
  add_signature_arguments(*command, arguments->signature);
  command->add_option("--runs", returning.runs, "of each ensemble")
      ->check(CLI::Range(2, 1'000'000))
      ->capture_default_str();
  command->add_option("--leave", returning.leave_s, "when the viewpoint goes, s")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  command->add_option("--away", returning.away_s, "how long it stays away, s")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  command->add_option("--rung", arguments->rung, "of the body meanwhile")
      ->check(CLI::IsMember({"support", "tables", "tables_on_hull"}))
      ->capture_default_str();
  add_starts_arguments(*command, returning.seed, returning.threads);
  command->add_flag("--json", arguments->json, "one JSON object on stdout");
  command->callback([arguments, &exit_code] {
    run_comparison(*arguments);
    exit_code = ExitCode::done;
  });
}

}  // namespace lodestone
