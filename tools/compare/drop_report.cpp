#include "tools/compare/drop_report.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <numbers>

#include "reference/output_file.h"
#include "tools/compare/comparison_report.h"
#include "tools/compare/drop_row_report.h"
#include "tools/results.h"
#include "tools/text_table.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

void write_drops(OutputFile& out, const std::string& method, const std::string& model, double dt_s,
                 const std::vector<DropObservation>& drops) {
  for (std::size_t i = 0; i < drops.size(); ++i) {
    const DropObservation& drop = drops[i];
    out.write(fmt::format("{},{},{},{},{},{},{},{},{},{},{},{}\n", method, model, dt_s, i, drop.bounces,
                          drop.rest_time_s, drop.distance_m, drop.first_rebound_m, int(drop.at_rest),
                          drop.up_in_body.x(), drop.up_in_body.y(), drop.up_in_body.z()));
  }
}

std::string table_of(const DropComparison& comparison) {
  TextTable table(drop_row_heading());
  table.add_row(cells_of_floor(comparison.floor));
  for (const DropRow& row : comparison.rows) table.add_row(cells_of(row));
  return table.text() + left_out_of(comparison.shape, comparison.rows);
}

ordered_json score_row_of(const DropComparison& comparison, const MethodAtStep& method,
                          const std::optional<ScoreWithInterval>& score, const std::optional<double>& ns) {
  ordered_json row = {{"shape", comparison.shape}, {"trials", comparison.trials}};
  row.update(json_of(method));
  row["score"] = score ? ordered_json(score->value.score) : ordered_json(nullptr);
  row["score_from"] = score ? ordered_json(score->interval[0]) : ordered_json(nullptr);
  row["score_to"] = score ? ordered_json(score->interval[1]) : ordered_json(nullptr);
  add_parts(row, score.value_or(ScoreWithInterval{}).value);
  row["ns_per_body_step"] = ns ? ordered_json(*ns) : ordered_json(nullptr);
  row["reason"] = or_null(method.reason);
  return row;
}

}  // namespace

std::string text_of(const DropJob& job, const DropComparison& comparison) {
  return fmt::format(
             "{}: {} drops, restitution {}, friction {}, slope {:.4g} deg; truth: ODE at {:.3g} ms{}\n\n",
             comparison.shape, comparison.trials, job.material.restitution, job.material.friction,
             job.conditions.slope * 180.0 / std::numbers::pi,
             1e3 * kObservationStep / comparison.truth_substeps,
             comparison.truth_push_m_per_s
                 ? fmt::format(", overlap pushed apart at {:.4g} m/s at most", *comparison.truth_push_m_per_s)
                 : "") +
         table_of(comparison) + '\n' + drop_row_footer();
}

ordered_json json_of(const DropComparison& comparison) {
  ordered_json json;
  json["shape"] = comparison.shape;
  json["trials"] = comparison.trials;
  json["truth"] = {{"step_s", kObservationStep / comparison.truth_substeps}};
  json["truth"]["push_m_per_s"] = comparison.truth_push_m_per_s ? ordered_json(*comparison.truth_push_m_per_s)
                                                                : ordered_json();  // ODE's own law
  json["truth"]["floor"] = comparison.floor.value.score;
  json["truth"]["floor_ci"] = comparison.floor.interval;
  add_parts(json["truth"], comparison.floor.value);
  json["rows"] = ordered_json::array();
  for (const DropRow& row : comparison.rows) json["rows"].push_back(json_of(row, comparison.floor));
  return json;
}

ordered_json score_rows_of(const DropComparison& comparison) {
  const MethodAtStep floor{
      .method = "noise_floor", .model = "", .dt_s = kObservationStep / comparison.truth_substeps};
  ordered_json rows = ordered_json::array();
  rows.push_back(score_row_of(comparison, floor, comparison.floor, std::nullopt));
  for (const DropRow& row : comparison.rows)
    rows.push_back(score_row_of(comparison, row, row.score, row.ns_per_body_step));
  return rows;
}

void save_scores(const DropComparison& comparison, const std::filesystem::path& file) {
  const ordered_json rows = score_rows_of(comparison);
  save_csv(rows, rows.front(), file);
}

void save_drops(const DropComparison& comparison, const std::filesystem::path& folder) {
  OutputFile out(folder / "drops.csv", "room for the drops");
  out.write(
      "method,model,dt_s,trial,bounces,rest_time_s,distance_m,first_rebound_m,at_rest,up_x,up_y,up_z\n");
  const double truth_step = kObservationStep / comparison.truth_substeps;
  write_drops(out, "truth_a", "", truth_step, comparison.truth_a);
  write_drops(out, "truth_b", "", truth_step, comparison.truth_b);
  for (const DropRow& row : comparison.rows) write_drops(out, row.method, row.model, row.dt_s, row.drops);
  out.close();
}

}  // namespace lodestone
