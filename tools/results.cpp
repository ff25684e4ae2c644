#include "tools/results.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "reference/output_file.h"
#include "tools/interrupt.h"

namespace lodestone {

using nlohmann::ordered_json;

namespace {

std::string quoted(const std::string& text) {
  std::string cell = "\"";
  for (const char c : text) cell.append(c == '"' ? 2 : 1, c);
  return cell + '"';
}

bool is_blank(const ordered_json& value) {
  return value.is_null() || (value.is_number_float() && !std::isfinite(value.get<double>()));
}

std::string cell_of(const ordered_json& value) {
  if (is_blank(value)) return "";
  if (value.is_string()) return quoted(value.get<std::string>());
  if (!value.is_array()) return value.dump();
  std::vector<std::string> elements;
  for (const ordered_json& element : value) elements.push_back(element.dump());
  return fmt::format("{}", fmt::join(elements, " "));
}

}  // namespace

void add_json_argument(Command& command, ResultArguments& arguments) {
  command.add_flag("--json", arguments.json, "one JSON object on stdout");
}

void add_table_arguments(Command& command, ResultArguments& arguments, const std::string& csv_what) {
  command.add_option("--csv", arguments.csv, csv_what).written();
  add_json_argument(command, arguments);
}

ordered_json or_null(const std::string& text) {
  return text.empty() ? ordered_json(nullptr) : ordered_json(text);
}
ordered_json or_null(const std::optional<double>& value) {
  return value ? ordered_json(*value) : ordered_json(nullptr);
}
ordered_json or_null(const std::optional<int>& value) {
  return value ? ordered_json(*value) : ordered_json(nullptr);
}

void print_json(ordered_json json) {
  if (is_interrupted()) json["incomplete"] = true;
  fmt::print("{}\n", json.dump(2, ' ', false, ordered_json::error_handler_t::replace));
}

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

void print_results(const ResultArguments& arguments, const ordered_json& json, const std::string& text) {
  if (arguments.json)
    print_json(json);
  else
    fmt::print("{}", text);
}

void print_table(const ResultArguments& arguments, const ordered_json& json, const ordered_json& example,
                 const std::string& text) {
  print_results(arguments, json, text);
  if (!arguments.csv.empty()) save_csv(json["rows"], example, arguments.csv);
}

}  // namespace lodestone
