#include "tools/csv_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "reference/output_file.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

std::string quoted(const std::string& text) {
  std::string cell = "\"";
  for (const char c : text) cell.append(c == '"' ? 2 : 1, c);
  return cell + '"';
}

std::string cell_of(const ordered_json& value) {
  if (value.is_null()) return "";
  if (value.is_string()) return quoted(value.get<std::string>());
  if (!value.is_array()) return value.dump();
  std::vector<std::string> elements;
  for (const ordered_json& element : value) elements.push_back(element.dump());
  return fmt::format("{}", fmt::join(elements, " "));
}

}  // namespace

void save_csv(const ordered_json& rows, const ordered_json& example, const std::filesystem::path& file) {
  OutputFile out(file, "room for the table");
  const auto write_line = [&](const ordered_json& row, const auto& text) {
    std::vector<std::string> cells;
    for (const auto& [key, value] : row.items()) cells.push_back(text(key, value));
    out.write(fmt::format("{}\n", fmt::join(cells, ",")));
  };
  write_line(example, [](const std::string& key, const ordered_json&) { return key; });
  for (const ordered_json& row : rows)
    write_line(row, [](const std::string&, const ordered_json& value) { return cell_of(value); });
  out.close();
}

}  // namespace lodestone
