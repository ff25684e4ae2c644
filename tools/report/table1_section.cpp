#include "tools/report/sections.h"

namespace lodestone {

using nlohmann::ordered_json;

ordered_json table1_section() {
  const ReportTable table = load_baseline("table1.csv");
  ordered_json section = {{"made", json_of(table.made)}, {"rows", ordered_json::array()}};
  for (const ordered_json& row : table.rows) {
    ordered_json shown;
    for (const char* key : {"bodies", "method", "model", "step_ms", "paper_step_ms", "reason"})
      shown[key] = row[key];
    if (row["model"] == "support")
      shown["paper_step_ms"] = nullptr;  // the paper's statistical bodies are spheres
    section["rows"].push_back(std::move(shown));
  }
  return section;
}

}  // namespace lodestone
