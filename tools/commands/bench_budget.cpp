#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "tools/bench/budget_bench.h"
#include "tools/commands.h"
#include "tools/progress.h"
#include "tools/results.h"
#include "tools/text_table.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

struct BenchBudgetArguments {
  BudgetBenchSettings bench;
  ResultArguments results;
};

constexpr std::array kRungsFromTheTop = {Rung::full, Rung::support, Rung::tables};

double over_percent(const BudgetFigures& figures) {
  return 100.0 * figures.over.value_or(0) / std::max(1, figures.steps);
}

std::string name_of(const BudgetFigures& f) {
  return f.budget_ms ? fmt::format("{:g} ms", *f.budget_ms) : fmt::format("{:g} units", *f.budget_work);
}

std::string text_of(const std::vector<BudgetBenchRow>& rows) {
  TextTable table({"budget", "threads", "median ms", "99 % ms", "longest ms", "steps over", "%", "kept",
                   "full, least-most", "support, least-most", "tables, least-most", "nearest full %",
                   "once settled %", "foretold ms", "measured ms", "apart ms", "state hash"});
  for (const BudgetBenchRow& row : rows) {
    const BudgetFigures& f = row.figures;
    std::vector<std::string> cells = {name_of(f), fmt::format("{}", row.threads), text_of_ms(f.step_ms.p50),
                                      text_of_ms(f.step_ms.p99), text_of_ms(f.step_ms.max)};
    if (f.over)
      cells.insert(cells.end(), {fmt::format("{}", *f.over), fmt::format("{:.2f}", over_percent(f)),
                                 is_kept(f) ? "yes" : "NO"});
    else
      cells.insert(cells.end(), {"-", "-", "-"});
    for (const Rung rung : kRungsFromTheTop) {
      const std::size_t i = std::size_t(rung);
      cells.push_back(fmt::format("{:.1f} {}-{}", f.mean_bodies[i], row.least[i], row.most[i]));
    }
    cells.insert(cells.end(),
                 {fmt::format("{:.1f}", 100 * row.nearest), fmt::format("{:.1f}", 100 * row.nearest_settled),
                  fmt::format("{:.3f}", f.mean_predicted_ms), fmt::format("{:.3f}", f.mean_measured_ms),
                  fmt::format("{:.3f}", f.mean_error_ms), fmt::format("{:016x}", row.state_hash)});
    table.add_row(std::move(cells));
  }
  return table.text();
}

// Once for the runs of a budget of work, which are alike.
std::string text_of_waiting(const std::vector<BudgetBenchRow>& rows, int bodies) {
  std::string text;
  bool worked = false;
  for (const BudgetBenchRow& row : rows) {
    if (row.figures.budget_work && std::exchange(worked, true)) continue;
    std::string whys;
    for (const auto& [why, count] : row.waiting)
      if (count >= 0.05) whys += fmt::format("{} {:.1f} ({})", whys.empty() ? "" : ",", count, why);
    if (!whys.empty())
      text += fmt::format("of the {} nearest, not full at {}, mean of steps:{}\n", std::min(kNearest, bodies),
                          name_of(row.figures), whys);
  }
  return text;
}

std::string text_of_repeating(double work, bool repeats) {
  return fmt::format("under {:g} units the runs on 1 and 2 threads, twice each, end {}", work,
                     repeats ? "in the same state" : "DIFFERENTLY");
}

ordered_json json_of(const BudgetBenchRow& row) {
  const BudgetFigures& f = row.figures;
  ordered_json json = {{"budget_ms", or_null(f.budget_ms)},
                       {"budget_work", or_null(f.budget_work)},
                       {"threads", row.threads},
                       {"steps", f.steps},
                       {"p50_ms", f.step_ms.p50},
                       {"p99_ms", f.step_ms.p99},
                       {"max_ms", f.step_ms.max},
                       {"over", or_null(f.over)}};
  json["over_percent"] = f.over ? ordered_json(over_percent(f)) : ordered_json(nullptr);
  json["kept"] = f.budget_ms ? ordered_json(is_kept(f)) : ordered_json(nullptr);
  for (const Rung rung : kRungsFromTheTop) {
    const std::size_t i = std::size_t(rung);
    const std::string name(name_of(rung));
    json["mean_" + name] = f.mean_bodies[i];
    json["min_" + name] = row.least[i];
    json["max_" + name] = row.most[i];
    json[name + "_predicted_ms"] = f.mean_cost[i].predicted_ms;
    json[name + "_measured_ms"] = f.mean_cost[i].measured_ms;
  }
  json["nearest_full_percent"] = 100 * row.nearest;
  json["nearest_full_settled_percent"] = 100 * row.nearest_settled;
  json["mean_predicted_ms"] = f.mean_predicted_ms;
  json["mean_measured_ms"] = f.mean_measured_ms;
  json["mean_error_ms"] = f.mean_error_ms;
  json["mean_work"] = f.mean_work;
  json["state_hash"] = fmt::format("{:016x}", row.state_hash);
  return json;
}

ExitCode run_budget(BenchBudgetArguments arguments) {
  const std::vector<BudgetBenchRow> rows = with_progress(arguments.bench, bench_budget);
  const bool repeats = repeats_exactly(rows);
  ordered_json json = {
      {"bodies", arguments.bench.bodies}, {"rows", ordered_json::array()}, {"work_repeats", repeats}};
  for (const BudgetBenchRow& row : rows) json["rows"].push_back(json_of(row));
  print_table(
      arguments.results, json, json_of(BudgetBenchRow{}),
      fmt::format(
          "{} bunnies fall into a heap around a viewpoint that jumps every {:g} s; processor time of whole "
          "steps from step {} on, and where bodies were\n"
          "kept: 99 % within 1.1 times the budget, at most 1 step in 100 over it, none over twice it\n"
          "nearest: of the n nearest to the viewpoint, where n are full, the part that is; once settled: "
          "half "
          "a second after a jump and later\n\n{}\n{}{}\n",
          arguments.bench.bodies, kJumpEvery_s, kFirstBudgetStep, text_of(rows),
          text_of_waiting(rows, arguments.bench.bodies),
          arguments.bench.work > 0.0 ? text_of_repeating(arguments.bench.work, repeats) : ""));
  const bool kept = std::ranges::all_of(rows, [](const BudgetBenchRow& row) { return is_kept(row.figures); });
  return kept && repeats ? ExitCode::done : ExitCode::check_failed;
}

}  // namespace

void add_bench_budget_command(Command& bench) {
  auto [command, arguments] = bench.add<BenchBudgetArguments>(
      "budget", "whether a budget is kept while bodies fall into a heap around a viewpoint that jumps",
      run_budget);
  BudgetBenchSettings& settings = arguments.bench;
  command.add_option("--bodies", settings.bodies, "that fall into the heap").within(1, 100'000);
  command.add_option("--budgets", settings.budgets_ms, "ms, several with commas")
      .several()
      .within(0.001, 1e6);
  command.add_option("--work", settings.work, "units of a budget of work; 0: none").within(0.0, 1e9);
  command.add_option("--steps", settings.steps, "of 1/60 s").within(kFirstBudgetStep, 1'000'000);
  command.add_option("--threads", settings.threads, "of the statistical level, under budgets of time")
      .within(1, 4096);
  command.add_option("--seed", settings.seed, "of the heap");
  add_table_arguments(command, arguments.results);
  command.add_footer("Exit code 1 where a budget was not kept, or a budget of work did not repeat exactly.");
}

}  // namespace lodestone
