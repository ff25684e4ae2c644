#include "tools/scores/score_pages.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "reference/error.h"
#include "tools/compare/drop_series.h"
#include "tools/compare/unseen_shapes.h"
#include "tools/report/report_table.h"

namespace lodestone {
namespace {

constexpr double kFrame = 0.016667;  // s, as it stands in the tables

// .052, 1.13, 9.1
std::string text_of_score(double score) {
  const std::string text = fmt::format("{:.{}f}", score, score < 0.9995 ? 3 : score < 1.995 ? 2 : 1);
  return text.starts_with("0.") ? text.substr(1) : text;
}

std::string row_of_cells(const std::vector<std::string>& cells) {
  return fmt::format("| {} |\n", fmt::join(cells, " | "));
}

// A heading and the rule under it.
std::string heading_of(const std::vector<std::string>& cells) {
  std::string rule = "|";
  for (std::size_t i = 0; i < cells.size(); ++i) rule += "---|";
  return row_of_cells(cells) + rule + '\n';
}

std::string join_commas(const std::vector<std::string>& texts) {
  return fmt::format("{}", fmt::join(texts, ", "));
}

/// Rows of one series, with the commits of those that were asked for.
class KeptScores {
 public:
  KeptScores(const std::vector<ScoreRow>& rows, std::string series)
      : rows_(rows), series_(std::move(series)) {}

  /// "": there is none.
  std::string score(const std::string& shape, const std::string& condition, const std::string& method) {
    const ScoreRow* row = find(shape, condition, method);
    return row ? text_of_score(row->score) : "";
  }
  std::string floor(const std::string& shape, const std::string& condition) {
    const ScoreRow* row = find(shape, condition, "support");
    return row ? text_of_score(row->floor) : "";
  }
  /// Score by score, the noise floor first; none where there is no floor.
  std::string beside_floor(const std::string& shape, const std::string& condition) {
    std::vector<std::string> texts = {floor(shape, condition)};
    if (texts.front().empty()) return "";
    for (const char* method : {"support", "tables", "full_1"})
      if (std::string text = score(shape, condition, method); !text.empty()) texts.push_back(std::move(text));
    return join_commas(texts);
  }
  std::string origin() const {
    return fmt::format("\nAt {}, steps of 1/60 s: `build/lodestone compare scores --only {}`.\n",
                       fmt::join(commits_, ", "), series_);
  }

 private:
  const ScoreRow* find(const std::string& shape, const std::string& condition, const std::string& method) {
    const auto row = std::ranges::find_if(rows_, [&](const ScoreRow& r) {
      return r.drops.series == series_ && r.drops.shape == shape && r.drops.condition == condition &&
             r.drops.method == method && r.drops.step_s == kFrame;
    });
    if (row == rows_.end()) return nullptr;
    commits_.insert(row->commit);
    return &*row;
  }

  const std::vector<ScoreRow>& rows_;
  std::string series_;
  std::set<std::string> commits_;
};

constexpr const char* kBesideFloor = "floor, `support`, `tables`, `full_1`";
constexpr std::array<std::pair<const char*, const char*>, 3> kShapes = {
    {{"box:0.2,0.3,0.4", "box"}, {"l:0.3,0.2,0.08,0.1", "L"}, {"bunny", "bunny"}}};

std::string table_of_conditions(const std::vector<ScoreRow>& rows, bool of_ground) {
  KeptScores kept(rows, "conditions");
  const auto shapes = std::span(kShapes).first(of_ground ? 2 : 3);
  std::vector<std::string> heading = {""};
  for (const auto& [shape, name] : shapes) heading.push_back(fmt::format("{}: {}", name, kBesideFloor));
  std::string table = heading_of(heading);
  for (const std::string& condition : condition_names()) {
    if (condition != "usual" && condition.starts_with("ground=") != of_ground) continue;
    std::vector<std::string> cells = {condition};
    for (const auto& [shape, name] : shapes) cells.push_back(kept.beside_floor(shape, condition));
    table += row_of_cells(cells);
  }
  return table + kept.origin();
}

std::string conditions_table(const std::vector<ScoreRow>& rows) { return table_of_conditions(rows, false); }
std::string ground_table(const std::vector<ScoreRow>& rows) { return table_of_conditions(rows, true); }

std::string shapes_table(const std::vector<ScoreRow>& rows) {
  KeptScores kept(rows, "shapes");
  std::string table = heading_of({"", "floor", "`support`", "`tables`", "`tables_published`", "`full_1`"});
  for (const UnseenShape& shape : unseen_shapes()) {
    const std::string name(shape.name);
    std::vector<std::string> cells = {name, kept.floor(name, "usual")};
    for (const char* method : {"support", "tables", "tables_published", "full_1"})
      cells.push_back(kept.score(name, "usual", method));
    table += row_of_cells(cells);
  }
  return table + kept.origin();
}

std::string materials_table(const std::vector<ScoreRow>& rows) {
  constexpr std::array<const char*, 5> kFrictions = {"0", "0.2", "0.5", "0.8", "1"};
  KeptScores kept(rows, "materials");
  std::string tables;
  for (const auto& named : std::span(kShapes).first(2)) {
    const auto shape = named.first, name = named.second;
    tables += heading_of(
        {fmt::format("{}: e", name), "`support`", "`tables`", "`tables_published`", "`full_1`", "floor"});
    for (const char* restitution : {"0", "0.2", "0.4", "0.6", "0.8", "0.9"}) {
      const auto across = [&](const auto& text_of) {
        std::vector<std::string> texts;
        for (const char* friction : kFrictions)
          texts.push_back(text_of(fmt::format("restitution={} friction={}", restitution, friction)));
        return join_commas(texts);
      };
      std::vector<std::string> cells = {restitution};
      for (const char* method : {"support", "tables", "tables_published", "full_1"})
        cells.push_back(
            across([&](const std::string& materials) { return kept.score(shape, materials, method); }));
      cells.push_back(across([&](const std::string& materials) { return kept.floor(shape, materials); }));
      tables += row_of_cells(cells);
    }
    tables += '\n';
  }
  return tables + kept.origin().substr(1);
}

/// A row of the table of single drops: how it is called there.
struct DropMethod {
  const char *method, *model, *text;
};

constexpr std::array<DropMethod, 14> kDropMethods = {{
    {"noise_floor", nullptr, "noise floor"},
    {"statistical", "support", "**`statistical`, `support`** (the default)"},
    {"statistical", "tables", "`statistical`, `tables`"},
    {"statistical", "tables_published", "`statistical`, `tables_published` (the paper's sphere)"},
    {"full", nullptr, "`full` (4 substeps in each step)"},
    {"full_1", nullptr, "`full_1` (ODE, hull contacts with planes)"},
    {"full_plain", nullptr, "`full_plain` (ODE as anyone would first write it)"},
    {"hull", nullptr, "`hull` (convex hull in ODE)"},
    {"low", nullptr, "`low` (194 faces in ODE)"},
    {"spheres7", nullptr, "`spheres7` (seven spheres in ODE)"},
    {"sphere", nullptr, "`sphere` (one sphere in ODE)"},
    {"bullet_hull", nullptr, "`bullet_hull` (Bullet)"},
    {"bullet_hull40", nullptr, "`bullet_hull40` (Bullet, at most 40 points)"},
    {"bullet_sphere", nullptr, "`bullet_sphere` (Bullet)"},
}};

std::vector<nlohmann::ordered_json> rows_of(const ReportTable& table, const DropMethod& method) {
  std::vector<nlohmann::ordered_json> rows;
  for (const auto& row : table.rows)
    if (row["method"] == method.method &&
        (method.model ? row["model"] == method.model : row["model"].is_null()) && !row["score"].is_null())
      rows.push_back(row);
  return rows;
}

// Score by score; of the last one its interval.
std::string scores_of(const std::vector<nlohmann::ordered_json>& rows, bool with_interval) {
  std::vector<std::string> texts;
  for (const auto& row : rows) texts.push_back(text_of_score(row["score"].get<double>()));
  if (texts.empty()) return "–";
  std::string text = fmt::format("{}", fmt::join(texts, " "));
  if (with_interval)
    text += fmt::format(" [{}, {}]", text_of_score(rows.back()["score_from"].get<double>()),
                        text_of_score(rows.back()["score_to"].get<double>()));
  return text;
}

std::string drops_table(const std::vector<ScoreRow>&) {
  constexpr std::array<const char*, 3> kFiles = {"scores_box.csv", "scores_l.csv", "scores_bunny.csv"};
  std::vector<ReportTable> tables;
  for (const char* file : kFiles) tables.push_back(load_baseline(file));
  std::string text = heading_of(
      {"method", "box .2 × .3 × .4 m", "L .3 × .2 m", "bunny .2 m, 4,698 faces", "ns: box, L, bunny"});
  for (const DropMethod& method : kDropMethods) {
    std::vector<std::string> cells = {method.text}, costs;
    bool any = false;
    for (const ReportTable& table : tables) {
      const auto rows = rows_of(table, method);
      const bool is_floor = std::string_view(method.method) == "noise_floor";
      any |= !rows.empty();
      cells.push_back(scores_of(rows, !is_floor && !rows.empty()));
      if (is_floor) continue;
      const bool has_cost = !rows.empty() && !rows.back()["ns_per_body_step"].is_null();
      costs.push_back(has_cost ? fmt::format("{:.0f}", rows.back()["ns_per_body_step"].get<double>()) : "–");
    }
    if (!any) continue;
    cells.push_back(join_commas(costs));
    text += row_of_cells(cells);
  }
  std::vector<std::string> origins;
  for (const ReportTable& table : tables)
    origins.push_back(fmt::format("{} drops at {}", std::int64_t(table.rows[0]["trials"].get<double>()),
                                  table.made.commit));
  return text + fmt::format("\n{}; {}: `tools/baselines scores_box scores_l scores_bunny`.\n",
                            join_commas(origins), tables[0].made.machine);
}

struct ScoreTable {
  const char* name;
  std::string (*make)(const std::vector<ScoreRow>&);
};

constexpr std::array<ScoreTable, 5> kTables = {{{"drops", drops_table},
                                                {"shapes", shapes_table},
                                                {"conditions", conditions_table},
                                                {"ground", ground_table},
                                                {"materials", materials_table}}};

constexpr std::string_view kBegin = "<!-- scores: ", kBeginEnd = " -->", kEnd = "<!-- end of scores -->";

std::string table_names() {
  std::vector<std::string> names;
  for (const ScoreTable& known : kTables) names.emplace_back(known.name);
  return join_commas(names);
}

const ScoreTable& find_table(const std::string& where, std::string_view name) {
  const auto table = std::ranges::find_if(kTables, [&](const ScoreTable& t) { return name == t.name; });
  if (table != kTables.end()) return *table;
  throw InputError(fmt::format("{}: found the table \"{}\", expected one of {}", where, name, table_names()));
}

}  // namespace

PageOfScores with_score_tables(std::string_view name, std::string_view page,
                               const std::vector<ScoreRow>& rows) {
  if (page.find(kBegin) == std::string_view::npos)
    throw InputError(fmt::format("{}: found no line {}NAME{}, expected one; NAME: one of {}", name, kBegin,
                                 kBeginEnd, table_names()));
  std::string made;
  int tables = 0;
  for (std::size_t at = 0;; ++tables) {
    const std::size_t begin = page.find(kBegin, at);
    if (begin == std::string_view::npos) return {made += page.substr(at), tables};
    const auto line = 1 + std::ranges::count(page.substr(0, begin), '\n');
    const std::string where = fmt::format("{}: line {}", name, line);
    const std::size_t table_begin = begin + kBegin.size(), table_end = page.find(kBeginEnd, table_begin),
                      end = page.find(kEnd, begin), next = page.find(kBegin, table_begin);
    if (table_end == std::string_view::npos || end == std::string_view::npos || next < end)
      throw InputError(fmt::format("{}: found a table without an end, expected {} under it", where, kEnd));
    const ScoreTable& table = find_table(where, page.substr(table_begin, table_end - table_begin));
    made += page.substr(at, table_end + kBeginEnd.size() - at);
    made += fmt::format("\n\n{}\n", table.make(rows));
    at = end;
  }
}

}  // namespace lodestone
