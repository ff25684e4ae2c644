#include "tools/report/sections.h"

namespace lodestone {

using nlohmann::ordered_json;

ordered_json hard_cases_section() {
  const ReportTable table = load_baseline("hard_cases.csv");
  int kept = 0, odes_own = 0;
  for (const ordered_json& row : table.rows) {
    if (row["pass"].get<bool>())
      ++kept;
    else if (!row["reason"].is_null())
      ++odes_own;
  }
  return {{"made", json_of(table.made)},
          {"figures", table.rows.size()},
          {"kept", kept},
          {"odes_own", odes_own},
          {"failed", int(table.rows.size()) - kept - odes_own},
          {"rows", table.rows}};
}

}  // namespace lodestone
