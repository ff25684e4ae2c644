#include "tools/compare/pile_report.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "reference/output_file.h"
#include "tools/compare/comparison_report.h"
#include "tools/results.h"
#include "tools/text_table.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

std::string percent(double fraction) { return fmt::format("{:+.1f}", 100.0 * fraction); }

std::vector<std::string> cells_of(const PileFigures& f) {
  return {fmt::format("{:.3f}", f.ke_l1),
          fmt::format("{:.2f}", f.sleep_time_s),
          percent(f.sleep_time_error),
          fmt::format("{:.3f}", f.mean_height_m),
          percent(f.mean_height_error),
          fmt::format("{:.1f}", 100.0 * f.penetration_over_size),
          fmt::format("{:.1f}", 100.0 * f.end_penetration_over_size),
          fmt::format("{:.1f}", 100.0 * f.median_penetration_over_size),
          fmt::format("{}", f.hovering),
          fmt::format("{}", f.escaped),
          fmt::format("{:.1e}", f.energy_rise)};
}

std::vector<std::string> row_of(std::vector<std::string> head, const PileFigures& figures) {
  const std::vector<std::string> numbers = cells_of(figures);
  head.insert(head.end(), numbers.begin(), numbers.end());
  return head;
}

std::vector<std::string> row_of(const PileRow& row) {
  std::vector<std::string> cells = cells_of(row);
  if (!row.figures) return cells;
  cells = row_of(std::move(cells), *row.figures);
  cells.push_back(fmt::format("{:.1e}", row.momentum_residual));
  if (row.ns_per_body_step) cells.push_back(fmt::format("{:.0f}", *row.ns_per_body_step));
  return cells;
}

std::string table_of(const PileComparison& comparison) {
  TextTable table({"method", "model", "step s", "substeps", "KE-L1", "sleep s", "error %", "height m",
                   "error %", "overlap %", "at end %", "median %", "hover", "escaped", "energy rise",
                   "momentum", "ns/body-step"});
  table.add_row(row_of({"truth", "", "", ""}, comparison.truth));
  table.add_row(row_of({"noise floor", "", "", ""}, comparison.floor));
  for (const PileRow& row : comparison.rows) table.add_row(row_of(row));
  return table.text() + left_out_of(comparison.shape, comparison.rows);
}

void add_figures(ordered_json& json, const PileFigures& f) {
  json["sleep_time_s"] = f.sleep_time_s;
  json["sleep_time_error"] = f.sleep_time_error;
  json["mean_height_m"] = f.mean_height_m;
  json["mean_height_error"] = f.mean_height_error;
  json["max_penetration_m"] = f.max_penetration_m;
  json["penetration_over_size"] = f.penetration_over_size;
  json["end_penetration_over_size"] = f.end_penetration_over_size;
  json["median_penetration_over_size"] = f.median_penetration_over_size;
  json["energy_rise"] = f.energy_rise;
  json["hovering"] = f.hovering;
  json["escaped"] = f.escaped;
}

// Every key in every row, null where the method was left out.
void add_nulls(ordered_json& json) {
  ordered_json keys;
  add_figures(keys, {});
  for (const auto& [key, value] : keys.items()) json[key] = nullptr;
  for (const char* key : {"ke_l1", "momentum_residual", "ns_per_body_step"}) json[key] = nullptr;
}

ordered_json json_of(const PileRow& row, const PileFigures& floor) {
  ordered_json json = json_of(row);
  if (row.figures) {
    json["ke_l1"] = row.figures->ke_l1;
    add_figures(json, *row.figures);
    json["momentum_residual"] = row.momentum_residual;
    json["ns_per_body_step"] = row.ns_per_body_step ? ordered_json(*row.ns_per_body_step) : ordered_json();
  } else {
    add_nulls(json);
  }
  json["floor_ke_l1"] = floor.ke_l1;
  json["reason"] = or_null(row.reason);
  return json;
}

void write_piles(OutputFile& out, const std::string& head, const std::vector<PileObservation>& piles) {
  for (std::size_t i = 0; i < piles.size(); ++i)
    out.write(fmt::format("{},{},{},{},{},{},{},{},{},{}\n", head, i, piles[i].sleep_time_s,
                          piles[i].mean_height_m, piles[i].max_penetration_m, piles[i].energy_rise,
                          piles[i].hovering, piles[i].escaped, piles[i].median_penetration_m,
                          piles[i].end_penetration_m));
}

void write_energy(OutputFile& out, const std::string& head, const std::vector<PileObservation>& piles) {
  for (std::size_t i = 0; i < piles.size(); ++i)
    for (std::size_t k = 0; k < piles[i].kinetic_energy.size(); ++k)
      out.write(fmt::format("{},{},{:.6g},{:.6g}\n", head, i, double(k) * kObservationStep,
                            piles[i].kinetic_energy[k]));
}

std::string head_of(const PileRow& row) { return fmt::format("{},{},{}", row.method, row.model, row.dt_s); }

// Calls `visit(head, piles)` for both batches of truth and for every row.
template <class Visit>
void each_batch(const PileComparison& comparison, Visit visit) {
  const double truth_step = kObservationStep / comparison.truth_substeps;
  visit(fmt::format("truth_a,,{}", truth_step), comparison.truth_a);
  visit(fmt::format("truth_b,,{}", truth_step), comparison.truth_b);
  for (const PileRow& row : comparison.rows) visit(head_of(row), row.piles);
}

template <class Write>
void save(const std::filesystem::path& file, Write write) {
  OutputFile out(file, "room for the piles");
  write(out);
  out.close();
}

}  // namespace

std::string text_of(const DropJob& job, const PileComparison& comparison) {
  return fmt::format(
             "{}: {} piles of {} bodies in a bin of {:.4g} m, restitution {}, friction {}; truth: ODE at "
             "{:.3g} ms\n\n",
             comparison.shape, comparison.pile_count, comparison.conditions.bodies,
             comparison.conditions.side, job.material.restitution, job.material.friction,
             1e3 * kObservationStep / comparison.truth_substeps) +
         table_of(comparison) +
         "\nKE-L1: sum over time of |mean kinetic energy - truth's| over the sum of the truth's; the noise "
         "floor is truth against truth with other starts\n"
         "sleep: mean of the bodies' last time above 2 mJ/kg; height: mean of the centres at the end; "
         "overlap: greatest, over the size; median: of the pairs that overlap at the end; hover: at rest on "
         "nothing\n"
         "energy rise: greatest above an earlier sample, over that at the start; momentum: greatest change "
         "without ground and gravity, over the bodies' own\n";
}

ordered_json json_of(const PileComparison& comparison) {
  ordered_json json;
  json["shape"] = comparison.shape;
  json["bodies"] = comparison.conditions.bodies;
  json["side_m"] = comparison.conditions.side;
  json["piles"] = comparison.pile_count;
  json["truth"] = {{"step_s", kObservationStep / comparison.truth_substeps},
                   {"quick_step_iterations", comparison.truth_iterations}};
  add_figures(json["truth"], comparison.truth);
  json["floor"] = {{"ke_l1", comparison.floor.ke_l1}};
  add_figures(json["floor"], comparison.floor);
  json["rows"] = ordered_json::array();
  for (const PileRow& row : comparison.rows) json["rows"].push_back(json_of(row, comparison.floor));
  return json;
}

void save_piles(const PileComparison& comparison, const std::filesystem::path& folder) {
  save(folder / "piles.csv", [&](OutputFile& out) {
    out.write(
        "method,model,dt_s,pile,sleep_time_s,mean_height_m,max_penetration_m,energy_rise,hovering,escaped,"
        "median_penetration_m,end_penetration_m\n");
    each_batch(comparison,
               [&](const std::string& head, const auto& piles) { write_piles(out, head, piles); });
  });
  save(folder / "pile_energy.csv", [&](OutputFile& out) {
    out.write("method,model,dt_s,pile,time_s,kinetic_energy_j_per_kg\n");
    each_batch(comparison,
               [&](const std::string& head, const auto& piles) { write_energy(out, head, piles); });
  });
}

}  // namespace lodestone
