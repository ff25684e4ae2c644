#include "tools/compare/series_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "reference/error.h"
#include "tools/text_table.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

// "2/4" as {2, 4}.
std::pair<int, int> share_of(const ordered_json& part) {
  int index = 0, count = 0;
  if (part.contains("shard") && part["shard"].is_string()) {
    const auto text = part["shard"].get<std::string>();
    if (std::sscanf(text.c_str(), "%d/%d", &index, &count) != 2) index = count = 0;
  }
  if (index < 1 || index > count || !part.contains("rows") || !part["rows"].is_array())
    throw InputError(
        "found a file that is no part of a comparison, "
        "expected what `compare … --shard I/N --json` prints");
  if (part.value("incomplete", false))
    throw InputError(
        fmt::format("found part {}/{} incomplete, expected one that ran to its end", index, count));
  return {index, count};
}

int case_of(const ordered_json& row) {
  if (!row.is_object() || !row.contains("case") || !row["case"].is_number_integer())
    throw InputError(fmt::format("found the row {}, expected one with the number of its case", row.dump()));
  return row["case"].get<int>();
}

// What all parts of a series have alike.
ordered_json identity_of(ordered_json part) {
  for (const char* own : {"shard", "rows"}) part.erase(own);
  return part;
}

void check_whole(std::span<const ordered_json> parts) {
  std::set<int> there;
  const int count = share_of(parts.front()).second;
  for (const ordered_json& part : parts) {
    const auto [index, of] = share_of(part);
    if (of != count)
      throw InputError(fmt::format("found part {}/{}, expected one of {} parts", index, of, count));
    if (!there.insert(index).second) throw InputError(fmt::format("found part {}/{} twice", index, of));
    if (identity_of(part) != identity_of(parts.front()))
      throw InputError(fmt::format("found part {}/{} of {}, expected {}", index, of, identity_of(part).dump(),
                                   identity_of(parts.front()).dump()));
  }
  for (int index = 1; index <= count; ++index)
    if (!there.contains(index))
      throw InputError(fmt::format("found no part {0}/{1}, expected all {1}", index, count));
}

}  // namespace

ordered_json merge_series(std::span<const ordered_json> parts) {
  if (parts.empty()) throw InputError("found no parts, expected at least one");
  check_whole(parts);
  std::map<int, std::vector<ordered_json>> rows;  // by case; the first case may be in every part
  for (const ordered_json& part : parts) {
    std::map<int, std::vector<ordered_json>> own;
    for (const ordered_json& row : part["rows"]) own[case_of(row)].push_back(row);
    rows.merge(own);
  }
  ordered_json merged = identity_of(parts.front());
  merged["rows"] = ordered_json::array();
  for (const auto& [number, of_case] : rows)
    for (const ordered_json& row : of_case) merged["rows"].push_back(row);
  return merged;
}

std::string material_tables_of(const ordered_json& series) {
  using Key = std::pair<double, double>;                        // restitution, friction
  std::map<std::string, std::map<Key, std::string>> of_method;  // scores
  std::vector<std::string> methods;                             // as they come
  std::set<double> restitutions, frictions;
  for (const ordered_json& row : series["rows"]) {
    const double restitution = row["restitution"].get<double>(), friction = row["friction"].get<double>();
    restitutions.insert(restitution), frictions.insert(friction);
    const std::string name = row["method"].get<std::string>() +
                             (row["model"].is_null() ? "" : " " + row["model"].get<std::string>()) +
                             fmt::format(", steps of {:.3g} s", row["dt_s"].get<double>());
    if (!of_method.contains(name)) methods.push_back(name);
    const auto& score = row["score"];
    of_method[name][{restitution, friction}] =
        score.is_null() ? ""
                        : fmt::format("{:.3f} ({:.3f})", score.get<double>(), row["floor"].get<double>());
  }
  std::string text;
  for (const std::string& method : methods) {
    std::vector<std::string> heading = {"restitution"};
    for (const double friction : frictions) heading.push_back(fmt::format("friction {:g}", friction));
    TextTable table(heading);
    for (const double restitution : restitutions) {
      std::vector<std::string> cells = {fmt::format("{:g}", restitution)};
      for (const double friction : frictions) cells.push_back(of_method[method][{restitution, friction}]);
      table.add_row(std::move(cells));
    }
    text += fmt::format("{}: score (noise floor)\n\n{}\n", method, table.text());
  }
  return text;
}

}  // namespace lodestone
