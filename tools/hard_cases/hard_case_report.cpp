#include "tools/hard_cases/hard_case_report.h"

#include <fmt/format.h>

#include <cmath>

#include "tools/results.h"
#include "tools/text_table.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

const char* op_of(const HardCaseRow& row) { return row.side == BoundSide::at_most ? "<=" : ">="; }

const char* verdict_of(const HardCaseRow& row) {
  if (passes(row)) return "pass";
  return row.odes_own.empty() ? "FAIL" : "ODE's own";
}

ordered_json json_of(const std::string& id, const HardCaseRow& row) {
  ordered_json json;
  json["id"] = id;
  json["what"] = row.what;
  json["value"] = std::isfinite(row.value) ? ordered_json(row.value) : ordered_json(nullptr);
  json["bound"] = row.bound;
  json["op"] = op_of(row);
  json["unit"] = row.unit;
  json["pass"] = passes(row);
  json["reason"] = passes(row) || row.odes_own.empty() ? ordered_json(nullptr) : ordered_json(row.odes_own);
  return json;
}

}  // namespace

std::string text_of(std::span<const HardCaseResult> results) {
  TextTable table({"case", "what", "figure", "bound", "unit", "result"});
  std::string reasons;
  int figures = 0, kept = 0;
  for (const HardCaseResult& result : results)
    for (const HardCaseRow& row : result.rows) {
      table.add_row({result.id, row.what, fmt::format("{:.4g}", row.value),
                     fmt::format("{} {:.4g}", op_of(row), row.bound), row.unit, verdict_of(row)});
      ++figures;
      if (passes(row))
        ++kept;
      else
        reasons +=
            fmt::format("{} {}: {}\n", result.id, row.what, row.odes_own.empty() ? "FAILED" : row.odes_own);
    }
  return table.text() + fmt::format("\n{} of {} figures keep their bound\n", kept, figures) + reasons;
}

ordered_json json_of(std::span<const HardCaseResult> results) {
  ordered_json json;
  json["cases"] = ordered_json::array();
  for (const HardCaseResult& result : results)
    for (const HardCaseRow& row : result.rows) json["cases"].push_back(json_of(result.id, row));
  return json;
}

void save_csv(std::span<const HardCaseResult> results, const std::filesystem::path& file) {
  save_csv(json_of(results)["cases"], json_of("", HardCaseRow{}), file);
}

ExitCode exit_code_of(std::span<const HardCaseResult> results) {
  for (const HardCaseResult& result : results)
    for (const HardCaseRow& row : result.rows)
      if (!passes(row) && row.odes_own.empty()) return ExitCode::check_failed;
  return ExitCode::done;
}

}  // namespace lodestone
