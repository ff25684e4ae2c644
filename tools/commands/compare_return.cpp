#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tools/commands.h"
#include "tools/compare/comparison_arguments.h"
#include "tools/compare/return_comparison.h"
#include "tools/progress.h"
#include "tools/results.h"
#include "tools/shape_arguments.h"
#include "tools/signature_arguments.h"

namespace lodestone {
namespace {

struct CompareReturnArguments {
  ShapeArguments shape;
  SignatureArguments signature;
  ReturnSettings returning;
  std::string rung = "support";
  ResultArguments results;
};

nlohmann::ordered_json json_of(const CompareReturnArguments& arguments, const std::string& shape,
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

std::string text_of(const CompareReturnArguments& arguments, const std::string& shape,
                    const ReturnComparison& found) {
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

void run_comparison(const CompareReturnArguments& arguments) {
  const DropJob job{.shape = make_shape_from_arguments(arguments.shape),
                    .conditions = {},
                    .material = arguments.shape.material};
  ReturnSettings settings = arguments.returning;
  settings.measuring = arguments.signature.measuring();
  settings.away = arguments.rung == "support" ? StatisticalModel::support : StatisticalModel::tables;
  settings.published = arguments.rung == "tables_published";
  const ReturnComparison found =
      with_progress(settings, [&](const auto& with_line) { return compare_return(job, with_line); });
  print_results(arguments.results, json_of(arguments, job.shape->name, found),
                text_of(arguments, job.shape->name, found));
}

}  // namespace

void add_compare_return_command(Command& compare) {
  auto [command, arguments] = compare.add<CompareReturnArguments>(
      "return", "a body that leaves the view and returns, against one that is full all the time",
      run_comparison);
  ReturnSettings& returning = arguments.returning;
  add_shape_arguments(command, arguments.shape);
  add_signature_arguments(command, arguments.signature);
  command.add_option("--runs", returning.runs, "of each ensemble").within(2, 1'000'000);
  command.add_option("--leave", returning.leave_s, "when the viewpoint goes, s").within(0.0, 10.0);
  command.add_option("--away", returning.away_s, "how long it stays away, s").within(0.0, 10.0);
  command.add_option("--rung", arguments.rung, "of the body meanwhile")
      .one_of({"support", "tables", "tables_published"});
  add_starts_arguments(command, returning.seed, returning.threads);
  add_json_argument(command, arguments.results);
}

}  // namespace lodestone
