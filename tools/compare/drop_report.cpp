#include "tools/compare/drop_report.h"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "reference/error.h"
#include "tools/text_table.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

std::string text_of(std::optional<double> value, int digits) {
  return value ? fmt::format("{:.{}f}", *value, digits) : "-";
}

// 1/60 where that is what it is.
std::string text_of_step(double dt_s) {
  const double per_second = 1.0 / dt_s;
  if (std::abs(per_second - std::round(per_second)) < 1e-3 * per_second) return fmt::format("1/{:.0f}", per_second);
  return fmt::format("{:.4g}", dt_s);
}

std::vector<std::string> cells_of(const ScoreWithInterval& scored) {
  const DropScore& score = scored.value;
  std::vector<std::string> cells = {text_of(score.score, 3), text_of(scored.interval[0], 3), text_of(scored.interval[1], 3)};
  for (const auto& part : {score.w_bounces, score.w_rest_time, score.w_distance, score.w_peak, score.ke_w, score.tv})
    cells.push_back(text_of(part, 3));
  return cells;
}

std::vector<std::string> cells_of(const DropRow& row) {
  std::vector<std::string> cells = {row.method, row.model, text_of_step(row.dt_s), fmt::format("{}", row.substeps)};
  if (row.score) {
    const std::vector<std::string> numbers = cells_of(*row.score);
    cells.insert(cells.end(), numbers.begin(), numbers.end());
  }
  if (row.ns_per_body_step) cells.push_back(text_of(row.ns_per_body_step, 0));
  return cells;
}

ordered_json json_or_null(std::optional<double> value) {
  return value && std::isfinite(*value) ? ordered_json(*value) : ordered_json(nullptr);
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
  ordered_json json;
  json["method"] = row.method;
  json["model"] = row.model.empty() ? ordered_json(nullptr) : ordered_json(row.model);
  json["dt_s"] = row.dt_s;
  json["substeps"] = row.substeps;
  json["score"] = row.score ? ordered_json(row.score->value.score) : ordered_json(nullptr);
  json["score_ci"] = row.score ? ordered_json(row.score->interval) : ordered_json(nullptr);
  json["floor"] = floor.value.score;
  json["floor_ci"] = floor.interval;
  add_parts(json, row.score.value_or(ScoreWithInterval{}).value);
  json["ns_per_body_step"] = json_or_null(row.ns_per_body_step);
  json["reason"] = row.reason.empty() ? ordered_json(nullptr) : ordered_json(row.reason);
  return json;
}

void write_drops(std::ostream& out, const std::string& method, const std::string& model, double dt_s,
                 const std::vector<DropObservation>& drops) {
  for (std::size_t i = 0; i < drops.size(); ++i) {
    const DropObservation& drop = drops[i];
    fmt::print(out, "{},{},{},{},{},{},{},{},{},{},{},{}\n", method, model, dt_s, i, drop.bounces, drop.rest_time_s,
               drop.distance_m, drop.first_rebound_m, int(drop.at_rest), drop.up_in_body.x(), drop.up_in_body.y(),
               drop.up_in_body.z());
  }
}

std::string table_of(const DropComparison& comparison) {
  TextTable table({"method", "model", "step s", "substeps", "score", "from", "to", "bounces", "rest time", "distance",
                   "rebound", "energy", "rest pose", "ns/body-step"});
  std::vector<std::string> floor = {"noise floor", "", "", ""};
  const std::vector<std::string> numbers = cells_of(comparison.floor);
  floor.insert(floor.end(), numbers.begin(), numbers.end());
  table.add_row(std::move(floor));
  std::string left_out;
  for (const DropRow& row : comparison.rows) {
    table.add_row(cells_of(row));
    const std::string line = fmt::format("{} left out: {} {}\n", row.method, comparison.shape, row.reason);
    if (!row.reason.empty() && left_out.find(line) == std::string::npos) left_out += line;  // once for all steps
  }
  return table.text() + left_out;
}

}  // namespace

std::string text_of(const DropJob& job, const DropComparison& comparison) {
  return fmt::format("{}: {} drops, restitution {}, friction {}, slope {:.4g} deg; truth: ODE at {:.3g} ms\n\n", comparison.shape,
                     comparison.trials, job.material.restitution, job.material.friction,
                     job.conditions.slope * 180.0 / std::numbers::pi, 1e3 * kObservationStep / comparison.truth_substeps) +
         table_of(comparison) +
         "\nscore: mean of the parts to its right; its 95 % bootstrap interval from .. to; the noise floor is truth against truth with other starts\n"
         "bounces .. rebound: Wasserstein-1 over the truth's deviation; energy: of the kinetic energy over 0-6 s; rest pose: total variation\n";
}

ordered_json json_of(const DropComparison& comparison) {
  ordered_json json;
  json["shape"] = comparison.shape;
  json["trials"] = comparison.trials;
  json["truth"] = {{"step_s", kObservationStep / comparison.truth_substeps}};
  json["truth"]["floor"] = comparison.floor.value.score;
  json["truth"]["floor_ci"] = comparison.floor.interval;
  add_parts(json["truth"], comparison.floor.value);
  json["rows"] = ordered_json::array();
  for (const DropRow& row : comparison.rows) json["rows"].push_back(json_of(row, comparison.floor));
  return json;
}

void save_drops(const DropComparison& comparison, const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  const std::filesystem::path file = folder / "drops.csv";
  std::ofstream out(file);
  out << "method,model,dt_s,trial,bounces,rest_time_s,distance_m,first_rebound_m,at_rest,up_x,up_y,up_z\n";
  const double truth_step = kObservationStep / comparison.truth_substeps;
  write_drops(out, "truth_a", "", truth_step, comparison.truth_a);
  write_drops(out, "truth_b", "", truth_step, comparison.truth_b);
  for (const DropRow& row : comparison.rows) write_drops(out, row.method, row.model, row.dt_s, row.drops);
  if (!out.flush()) throw InputError(fmt::format("{}: cannot be written", file.string()));
}

}  // namespace lodestone
