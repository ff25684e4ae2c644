#include "tools/bench/broad_phase_report.h"

#include <fmt/format.h>

#include "tools/results.h"
#include "tools/text_table.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

std::string or_blank(const std::optional<double>& value) {
  return value ? fmt::format("{:.0f}", *value) : "-";
}

}  // namespace

std::string text_of(std::span<const BroadPhaseRow> rows) {
  TextTable table({"layout", "bodies", "fill ns", "pairs ns", "both ns", "pairs/body", "cells", "grids",
                   "flat", "bytes/body", "ODE hash", "ODE sweep", "Bullet tree", "x less", "checked by"});
  std::string faults;
  for (const BroadPhaseRow& row : rows) {
    table.add_row({row.layout, fmt::format("{}", row.bodies), fmt::format("{:.1f}", row.fill_ns),
                   fmt::format("{:.1f}", row.pairs_ns), fmt::format("{:.1f}", row.fill_ns + row.pairs_ns),
                   fmt::format("{:.2f}", row.pairs_per_body), fmt::format("{}", row.cells),
                   fmt::format("{}", row.grids), row.flat ? "yes" : "no",
                   fmt::format("{:.0f}", row.bytes_per_body), or_blank(row.ode_hash_ns),
                   or_blank(row.ode_sweep_ns), or_blank(row.bullet_tree_ns),
                   row.times_less ? fmt::format("{:.1f}", *row.times_less) : "-", row.checked_by});
    if (!row.fault.empty())
      faults += fmt::format("wrong: {} of {} bodies: {}\n", row.layout, row.bodies, row.fault);
  }
  return table.text() + (faults.empty() ? "" : '\n' + faults);
}

ordered_json json_of(const BroadPhaseRow& row) {
  return {{"layout", row.layout},
          {"bodies", row.bodies},
          {"threads", row.threads},
          {"fill_ns_per_body", row.fill_ns},
          {"pairs_ns_per_body", row.pairs_ns},
          {"pairs_per_body", row.pairs_per_body},
          {"cells", row.cells},
          {"grids", row.grids},
          {"flat", row.flat},
          {"bytes_per_body", row.bytes_per_body},
          {"ode_hash_ns_per_body", or_null(row.ode_hash_ns)},
          {"ode_sweep_ns_per_body", or_null(row.ode_sweep_ns)},
          {"bullet_tree_ns_per_body", or_null(row.bullet_tree_ns)},
          {"times_less_than_fastest", or_null(row.times_less)},
          {"checked_by", or_null(row.checked_by)},
          {"fault", or_null(row.fault)}};
}

ordered_json json_of(std::span<const BroadPhaseRow> rows) {
  ordered_json json = {{"rows", ordered_json::array()}};
  for (const BroadPhaseRow& row : rows) json["rows"].push_back(json_of(row));
  return json;
}

}  // namespace lodestone
