#include "tools/compare/drop_series.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>

#include "reference/mass_bounds.h"
#include "tools/compare/drop_row_report.h"
#include "tools/interrupt.h"
#include "tools/text_table.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

// None where one of them was left out, or the first is no more off than can be told.
std::optional<double> score_over(const DropRow& row, const DropRow& first) {
  if (!row.score || !first.score || first.score->value.score <= 0.0) return {};
  return row.score->value.score / first.score->value.score;
}

struct Condition {
  std::string name;
  std::function<void(DropJob&)> set;
};

std::vector<Condition> make_conditions() {
  std::vector<Condition> list = {{"usual", [](DropJob&) {}}};
  const auto add = [&](const std::string& what, std::initializer_list<double> values,
                       void (*set)(DropJob&, double)) {
    for (const double value : values)
      list.push_back({fmt::format("{}={:g}", what, value), [=](DropJob& job) { set(job, value); }});
  };
  add("restitution", {0.0, 0.2, 0.6, 0.8, 0.9}, [](DropJob& job, double e) { job.material.restitution = e; });
  add("friction", {0.0, 0.2, 0.8, 1.0}, [](DropJob& job, double mu) { job.material.friction = mu; });
  add("speed_scale", {3.0}, [](DropJob& job, double factor) { job.conditions.speed_scale *= factor; });
  add("slope_deg", {10.0, 20.0, 30.0, 40.0},
      [](DropJob& job, double degrees) { job.conditions.slope = degrees * std::numbers::pi / 180.0; });
  add("size_m", {0.001, 0.01, 0.1, 1.0, 10.0}, [](DropJob& job, double size) {
    job.shape = std::make_shared<const Shape>(scale_shape(*job.shape, size / job.shape->size));
    job.material.density = std::max(job.material.density, kLeastMass / job.shape->volume * (1.0 + 1e-9));
  });
  for (const auto& [ground, name] : kUnevenGrounds)
    list.push_back(
        {fmt::format("ground={}", name), [ground = ground](DropJob& job) { job.ground = ground; }});
  return list;
}

}  // namespace

std::vector<std::string> condition_names() {
  std::vector<std::string> names;
  for (const Condition& condition : make_conditions()) names.push_back(condition.name);
  return names;
}

std::vector<DropCase> make_condition_cases(const DropJob& usual) {
  std::vector<DropCase> cases;
  for (const Condition& condition : make_conditions()) {
    cases.push_back({condition.name, usual, int(cases.size())});
    condition.set(cases.back().job);
  }
  return cases;
}

std::vector<DropCase> make_material_cases(const DropJob& usual) {
  std::vector<DropCase> cases;
  for (const double restitution : {0.0, 0.2, 0.4, 0.6, 0.8, 0.9})
    for (const double friction : {0.0, 0.2, 0.5, 0.8, 1.0}) {
      DropCase& one = cases.emplace_back(
          DropCase{fmt::format("restitution={:g} friction={:g}", restitution, friction), usual});
      one.job.material.restitution = restitution;
      one.job.material.friction = friction;
      one.index = int(cases.size()) - 1;
    }
  return cases;
}

void keep_share(std::vector<DropCase>& cases, const Share& share, bool keep_first) {
  std::erase_if(
      cases, [&](const DropCase& one) { return !share.holds(one.index) && !(keep_first && one.index == 0); });
}

std::vector<DropComparison> compare_series(std::span<const DropCase> cases,
                                           const DropComparisonSettings& settings) {
  std::vector<DropComparison> series;
  const auto compare = [&](const DropCase& one) {
    DropComparisonSettings with_name = settings;
    if (settings.progress)
      with_name.progress = [&](const std::string& stage, double fraction) {
        settings.progress(fmt::format("{} of {}, {}: {}", series.size() + 1, cases.size(), one.name, stage),
                          fraction);
      };
    series.push_back(compare_drops(one.job, with_name));
  };
  until_interrupted([&] { std::ranges::for_each(cases, compare); });
  return series;
}

std::string text_of(const std::string& what, std::span<const DropCase> cases,
                    std::span<const DropComparison> series, bool over_first) {
  std::vector<std::string> heading = {what};
  std::ranges::move(drop_row_heading(), std::back_inserter(heading));
  heading.insert(heading.begin() + 5, "floor");
  if (over_first) heading.insert(heading.begin() + 7, "x " + cases[0].name);
  TextTable table(heading);
  for (std::size_t i = 0; i < series.size(); ++i)
    for (std::size_t k = 0; k < series[i].rows.size(); ++k) {
      const DropRow& row = series[i].rows[k];
      std::vector<std::string> cells = {cases[i].name};
      std::ranges::move(cells_of(row), std::back_inserter(cells));
      if (row.score) {
        cells.insert(cells.begin() + 5, fmt::format("{:.3f}", series[i].floor.value.score));
        if (over_first) {
          const auto over = score_over(row, series[0].rows[k]);
          cells.insert(cells.begin() + 7, over ? fmt::format("{:.2f}", *over) : "-");
        }
      }
      table.add_row(std::move(cells));
    }
  return table.text() + '\n' + drop_row_footer();
}

ordered_json json_of(const std::string& key, std::span<const DropCase> cases,
                     std::span<const DropComparison> series, bool over_first) {
  ordered_json json;
  json["trials"] = series.empty() ? 0 : series[0].trials;
  json["rows"] = ordered_json::array();
  for (std::size_t i = 0; i < series.size(); ++i)
    for (std::size_t k = 0; k < series[i].rows.size(); ++k) {
      ordered_json row;
      row[key] = cases[i].name;
      row["case"] = cases[i].index;
      row["restitution"] = cases[i].job.material.restitution;
      row["friction"] = cases[i].job.material.friction;
      row.update(json_of(series[i].rows[k], series[i].floor));
      const auto over = over_first ? score_over(series[i].rows[k], series[0].rows[k]) : std::nullopt;
      if (over_first) row["score_over_first"] = over ? ordered_json(*over) : ordered_json(nullptr);
      json["rows"].push_back(std::move(row));
    }
  return json;
}

}  // namespace lodestone
