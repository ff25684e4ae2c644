#include <algorithm>
#include <span>

#include "scenes/budget_figures.h"
#include "tools/report/sections.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

// Rows of one run, in the order of their steps; figures of one that ended before any step counts are null.
ordered_json run_of(const ordered_json& rows) {
  ordered_json run = {{"scene", rows.front()["scene"]},
                      {"budget_ms", rows.front()["budget_ms"]},
                      {"dt_s", rows.front()["dt_s"]}};
  for (const char* key : {"full", "support", "tables", "asleep", "processor_ms"}) {
    run[key] = ordered_json::array();
    for (const ordered_json& row : rows) run[key].push_back(row[key]);
  }
  const std::vector<double> all = run["processor_ms"].get<std::vector<double>>();
  const auto ms = std::span(all).subspan(std::min<std::size_t>(kFirstBudgetStep - 1, all.size()));
  const TimeSummary summary = summarize(ms);
  const auto counted = [&](auto figure) { return ms.empty() ? ordered_json(nullptr) : ordered_json(figure); };
  run["counted_steps"] = ms.size();
  run["p50_ms"] = counted(summary.p50), run["p99_ms"] = counted(summary.p99);
  run["max_ms"] = counted(summary.max);
  run["over"] =
      run["budget_ms"].is_null()
          ? ordered_json(nullptr)
          : counted(std::ranges::count_if(ms, [&](double x) { return x > run["budget_ms"].get<double>(); }));
  return run;
}

}  // namespace

ordered_json budget_section(const std::optional<FreshResults>& fresh) {
  const ReportTable table = fresh && !fresh->steps.rows.empty() ? fresh->steps : load_baseline("steps.csv");
  ordered_json section = {{"made", json_of(table.made)}, {"runs", ordered_json::array()}};
  ordered_json rows = ordered_json::array();
  const auto finish = [&] {
    if (!rows.empty()) section["runs"].push_back(run_of(rows));
    rows = ordered_json::array();
  };
  for (const ordered_json& row : table.rows) {
    if (row["step"] == 1) finish();
    rows.push_back(row);
  }
  finish();
  if (fresh) section["levels"] = fresh->levels.rows;
  return section;
}

}  // namespace lodestone
