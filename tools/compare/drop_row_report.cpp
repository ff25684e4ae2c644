#include "tools/compare/drop_row_report.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tools/compare/comparison_report.h"
#include "tools/results.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

std::string text_of(std::optional<double> value, int digits) {
  return value ? fmt::format("{:.{}f}", *value, digits) : "-";
}

std::vector<std::string> cells_of(const ScoreWithInterval& scored) {
  const DropScore& score = scored.value;
  std::vector<std::string> cells = {text_of(score.score, 3), text_of(scored.interval[0], 3),
                                    text_of(scored.interval[1], 3)};
  for (const auto& part :
       {score.w_bounces, score.w_rest_time, score.w_distance, score.w_peak, score.ke_w, score.tv})
    cells.push_back(text_of(part, 3));
  return cells;
}

ordered_json json_or_null(std::optional<double> value) {
  return value && std::isfinite(*value) ? ordered_json(*value) : ordered_json(nullptr);
}

ordered_json json_of(const ImpactErrors& errors) {
  return {{"impacts", errors.impacts},
          {"impulse_error_10pct_median", errors.impulse_median},
          {"impulse_error_10pct_mean", errors.impulse_mean},
          {"unnoticed", errors.unnoticed},
          {"angle_deg_median", errors.angle_deg},
          {"speed_change_mean", errors.speed_change}};
}

}  // namespace

std::vector<std::string> drop_row_heading() {
  return {"method",    "model",    "step s",  "substeps", "score",     "from",       "to",          "bounces",
          "rest time", "distance", "rebound", "energy",   "rest pose", "impact/10%", "ns/body-step"};
}

std::string drop_row_footer() {
  return "score: mean of the parts to its right; its 95 % bootstrap interval from .. to; the noise floor is "
         "truth against truth with other starts\n"
         "bounces .. rebound: Wasserstein-1 over the truth's deviation; energy: of the kinetic energy over "
         "0-6 s; rest pose: total variation\n"
         "impact/10%: median error of the first impact's impulse against the truth from the same start, in "
         "tenths of the impulse; viewers notice about one\n";
}

std::vector<std::string> cells_of_floor(const ScoreWithInterval& floor) {
  std::vector<std::string> cells = {"noise floor", "", "", ""};
  const std::vector<std::string> numbers = cells_of(floor);
  cells.insert(cells.end(), numbers.begin(), numbers.end());
  return cells;
}

std::vector<std::string> cells_of(const DropRow& row) {
  std::vector<std::string> cells = cells_of(static_cast<const MethodAtStep&>(row));
  if (row.score) {
    const std::vector<std::string> numbers = cells_of(*row.score);
    cells.insert(cells.end(), numbers.begin(), numbers.end());
    cells.push_back(row.first_impacts ? text_of(row.first_impacts->impulse_median, 2) : "-");
  }
  if (row.ns_per_body_step) cells.push_back(text_of(row.ns_per_body_step, 0));
  return cells;
}

void add_parts(ordered_json& json, const DropScore& score) {
  json["parts"] = score.parts;
  json["w_bounces"] = json_or_null(score.w_bounces);
  json["w_rest_time"] = json_or_null(score.w_rest_time);
  json["w_distance"] = json_or_null(score.w_distance);
  json["w_peak"] = json_or_null(score.w_peak);
  json["ke_w"] = json_or_null(score.ke_w);
  json["tv"] = json_or_null(score.tv);
}

ordered_json json_of(const DropRow& row, const ScoreWithInterval& floor) {
  ordered_json json = json_of(static_cast<const MethodAtStep&>(row));
  json["score"] = row.score ? ordered_json(row.score->value.score) : ordered_json(nullptr);
  json["score_ci"] = row.score ? ordered_json(row.score->interval) : ordered_json(nullptr);
  json["floor"] = floor.value.score;
  json["floor_ci"] = floor.interval;
  add_parts(json, row.score.value_or(ScoreWithInterval{}).value);
  json["ns_per_body_step"] = json_or_null(row.ns_per_body_step);
  json["first_impact"] = row.first_impacts ? json_of(*row.first_impacts) : ordered_json(nullptr);
  json["table_extrapolations"] = row.table_extrapolations();
  json["reason"] = or_null(row.reason);
  return json;
}

}  // namespace lodestone
