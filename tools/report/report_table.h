// A table that the report shows, and how it was made.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace lodestone {

/// How figures were made.
struct Provenance {
  std::vector<std::string> commands;
  std::string commit, machine, date;
  bool fresh = false;  ///< by the program that writes the report, just now
};

struct ReportTable {
  Provenance made;
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();  ///< objects, all with the same keys
};

/// Of a line of CSV: the text, and whether it stood in double quotes.
struct CsvCell {
  std::string text;
  bool quoted = false;
};
std::vector<CsvCell> cells_of(std::string_view line);

/// Of CSV text whose first lines are comments, `# command: …` (any number), `# commit: …`, `# machine: …`, `#
/// date: …`, then the keys, then a line a row. A cell is a number where it reads as one, null where it is
/// empty, text in double quotes or not; `name` heads what InputError says is wrong.
ReportTable parse_report_table(std::string_view name, std::string_view csv);

/// tests/baselines/NAME, which is in the program. Throws std::logic_error where there is no such file.
ReportTable load_baseline(std::string_view name);

nlohmann::ordered_json json_of(const Provenance& made);

}  // namespace lodestone
