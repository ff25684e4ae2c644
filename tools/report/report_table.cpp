#include "tools/report/report_table.h"

#include <fmt/format.h>

#include <charconv>
#include <stdexcept>

#include "reference/error.h"
#include "tools/pages/page_texts.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

std::string_view take_line(std::string_view& text) {
  const std::string_view line = text.substr(0, text.find('\n'));
  text.remove_prefix(std::min(text.size(), line.size() + 1));
  return line.ends_with('\r') ? line.substr(0, line.size() - 1) : line;
}

ordered_json value_of(const CsvCell& cell) {
  if (cell.quoted) return cell.text;
  if (cell.text.empty()) return nullptr;
  if (cell.text == "true" || cell.text == "false") return cell.text == "true";
  double value = 0.0;
  const char* end = cell.text.data() + cell.text.size();
  const auto read = std::from_chars(cell.text.data(), end, value);
  return read.ec == std::errc() && read.ptr == end ? ordered_json(value) : ordered_json(cell.text);
}

void read_comment(std::string_view line, Provenance& made) {
  const auto value_after = [&](std::string_view key) {
    return line.starts_with(key) ? std::optional(std::string(line.substr(key.size()))) : std::nullopt;
  };
  if (const auto command = value_after("# command: ")) made.commands.push_back(*command);
  if (const auto commit = value_after("# commit: ")) made.commit = *commit;
  if (const auto machine = value_after("# machine: ")) made.machine = *machine;
  if (const auto date = value_after("# date: ")) made.date = *date;
}

}  // namespace

std::vector<CsvCell> cells_of(std::string_view line) {
  std::vector<CsvCell> cells(1);
  bool inside = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && inside && i + 1 < line.size() && line[i + 1] == '"')
      cells.back().text += line[++i];  // two of them stand for one
    else if (c == '"')
      inside = !inside, cells.back().quoted = true;
    else if (c == ',' && !inside)
      cells.emplace_back();
    else
      cells.back().text += c;
  }
  return cells;
}

ReportTable parse_report_table(std::string_view name, std::string_view csv) {
  ReportTable table;
  std::string_view line = take_line(csv);
  int number = 1;
  for (; line.starts_with('#'); ++number) read_comment(line, table.made), line = take_line(csv);
  const std::vector<CsvCell> keys = cells_of(line);
  while (!csv.empty()) {
    const std::vector<CsvCell> cells = cells_of(take_line(csv));
    ++number;
    if (cells.size() != keys.size())
      throw InputError(
          fmt::format("{}: line {}: found {} cells, expected {}", name, number, cells.size(), keys.size()));
    ordered_json row;
    for (std::size_t i = 0; i < keys.size(); ++i) row[keys[i].text] = value_of(cells[i]);
    table.rows.push_back(std::move(row));
  }
  return table;
}

ReportTable load_baseline(std::string_view name) {
  const auto text = find_page_text(name);
  if (!text) throw std::logic_error(fmt::format("no baseline {}", name));
  return parse_report_table(name, *text);
}

ordered_json json_of(const Provenance& made) {
  return {{"commands", made.commands},
          {"commit", made.commit},
          {"machine", made.machine},
          {"date", made.date},
          {"fresh", made.fresh}};
}

}  // namespace lodestone
