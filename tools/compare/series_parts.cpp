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

struct Part {
  const ordered_json& json;
  const std::string& name;
  [[noreturn]] void fail(const std::string& found, const std::string& expected) const {
    throw_input_error(name, found, expected);
  }
};

// "2/4" as {2, 4}.
std::pair<int, int> share_of(const Part& part) {
  int index = 0, count = 0;
  if (part.json.contains("shard") && part.json["shard"].is_string()) {
    const auto text = part.json["shard"].get<std::string>();
    if (std::sscanf(text.c_str(), "%d/%d", &index, &count) != 2) index = count = 0;
  }
  if (index < 1 || index > count || !part.json.contains("rows") || !part.json["rows"].is_array())
    part.fail("a file that is no part of a comparison", "what `compare … --shard I/N --json` prints");
  if (part.json.value("incomplete", false))
    part.fail(fmt::format("part {}/{} incomplete", index, count), "one that ran to its end");
  return {index, count};
}

// A row as the tables read it.
int case_of(const Part& part, const ordered_json& row) {
  const auto is = [&](const char* key, auto holds) { return row.contains(key) && (row[key].*holds)(); };
  using Json = ordered_json;
  const bool sound =
      row.is_object() && is("case", &Json::is_number_integer) &&
      (!row.contains("materials") ||
       (is("restitution", &Json::is_number) && is("friction", &Json::is_number) &&
        is("method", &Json::is_string) && is("dt_s", &Json::is_number) &&
        (is("model", &Json::is_null) || is("model", &Json::is_string)) &&
        (is("score", &Json::is_null) || (is("score", &Json::is_number) && is("floor", &Json::is_number)))));
  if (!sound)
    part.fail(fmt::format("the row {}", row.dump()), "one of a comparison, with the number of its case");
  return row["case"].get<int>();
}

// What all parts of a series have alike.
ordered_json identity_of(ordered_json part) {
  for (const char* own : {"shard", "rows"}) part.erase(own);
  return part;
}

void check_whole(std::span<const Part> parts) {
  std::set<int> there;
  const int count = share_of(parts.front()).second;
  for (const Part& part : parts) {
    const auto [index, of] = share_of(part);
    if (of != count) part.fail(fmt::format("part {}/{}", index, of), fmt::format("one of {} parts", count));
    if (!there.insert(index).second) part.fail(fmt::format("part {}/{} twice", index, of), "each once");
    if (identity_of(part.json) != identity_of(parts.front().json))
      part.fail(fmt::format("part {}/{} of {}", index, of, identity_of(part.json).dump()),
                identity_of(parts.front().json).dump());
  }
  for (int index = 1; index <= count; ++index)
    if (!there.contains(index))
      throw InputError(fmt::format("found no part {0}/{1}, expected all {1}", index, count));
}

}  // namespace

ordered_json merge_series(std::span<const ordered_json> jsons, std::span<const std::string> names) {
  check_that(jsons.size() == names.size(), "each part has a name");
  if (jsons.empty()) throw InputError("found no parts, expected at least one");
  std::vector<Part> parts;
  for (std::size_t i = 0; i < jsons.size(); ++i) parts.push_back({jsons[i], names[i]});
  check_whole(parts);
  std::map<int, std::vector<ordered_json>> rows;  // by case; the first case may be in every part
  for (const Part& part : parts) {
    std::map<int, std::vector<ordered_json>> own;
    for (const ordered_json& row : part.json["rows"]) own[case_of(part, row)].push_back(row);
    rows.merge(own);
  }
  ordered_json merged = identity_of(jsons.front());
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
