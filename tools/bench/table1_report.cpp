#include "tools/bench/table1_report.h"

#include <fmt/format.h>

#include "tools/results.h"
#include "tools/text_table.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

ordered_json positive_or_null(double value) {
  return value > 0.0 ? ordered_json(value) : ordered_json(nullptr);
}

std::string ms_or_blank(const std::optional<double>& ms) { return ms ? fmt::format("{:.4f}", *ms) : ""; }
std::string times_or_blank(const std::optional<double>& times) {
  return times ? fmt::format("{:.3g}", *times) : "";
}

// Of a step, over the first column of as many bodies: the paper's percentages.
std::string paper_percent(const PaperTimes& paper, int bodies) {
  const PaperTimes whole = paper_times(bodies == 10'000 ? "spheres7" : "full_plain", bodies);
  return paper.step_ms > 0.0 && whole.step_ms > 0.0
             ? fmt::format("{:.2f}", 100.0 * paper.step_ms / whole.step_ms)
             : "";
}

std::string percent_of(const Table1Row& row) {
  const auto& times =
      row.times_less_than_full_plain ? row.times_less_than_full_plain : row.times_less_than_spheres7;
  return times ? fmt::format("{:.3g}", 100.0 / *times) : "";
}

}  // namespace

std::string text_of(std::span<const Table1Row> rows) {
  TextTable table({"bodies", "method", "step ms", "collision", "response", "rest", "%", "x plain", "x 7",
                   "x 1", "paper ms", "paper %", "awake 60 120 179", "B/body", "in level", "state hash"});
  std::string reasons;
  for (const Table1Row& row : rows) {
    const std::string name = row.model.empty() ? row.method : fmt::format("{} {}", row.method, row.model);
    const PaperTimes paper =
        paper_times(row.model == "support" || row.model == "tables" ? "" : row.method, row.bodies);
    if (!row.step_ms) reasons += fmt::format("left out: {} bodies, {}: {}\n", row.bodies, name, row.left_out);
    const bool measured = row.step_ms.has_value();
    table.add_row(
        {fmt::format("{}", row.bodies), name, ms_or_blank(row.step_ms), ms_or_blank(row.collision_ms),
         ms_or_blank(row.response_ms), ms_or_blank(row.rest_ms), percent_of(row),
         times_or_blank(row.times_less_than_full_plain), times_or_blank(row.times_less_than_spheres7),
         times_or_blank(row.times_less_than_sphere),
         paper.step_ms > 0.0 ? fmt::format("{:.5f}", paper.step_ms) : "", paper_percent(paper, row.bodies),
         measured ? fmt::format("{} {} {}", row.awake[0], row.awake[1], row.awake[2]) : "",
         measured ? fmt::format("{:.0f}", row.bytes_per_body) : "",
         measured && row.level_bytes_per_body > 0.0 ? fmt::format("{:.0f}", row.level_bytes_per_body) : "",
         measured ? fmt::format("{:016x}", row.state_hash) : ""});
  }
  return table.text() + (reasons.empty() ? "" : '\n' + reasons);
}

std::string roofline_text_of(const Bandwidth& bandwidth, std::span<const Table1Row> rows) {
  TextTable table({"bodies", "method", "threads", "MB in level", "bytes moved/body", "GB/s", "% of memory",
                   "% of cache"});
  for (const Table1Row& row : rows)
    if (row.moved_gb_per_s)
      table.add_row({fmt::format("{}", row.bodies), fmt::format("{} {}", row.method, row.model),
                     fmt::format("{}", row.threads),
                     fmt::format("{:.1f}", 1e-6 * row.level_bytes_per_body * row.bodies),
                     fmt::format("{:.0f}", row.bytes_moved_per_body),
                     fmt::format("{:.2f}", *row.moved_gb_per_s),
                     fmt::format("{:.0f}", 100.0 * *row.share_of_memory),
                     fmt::format("{:.0f}", 100.0 * *row.share_of_cache)});
  return fmt::format(
      "roofline: a triad moves {:.1f} GB/s in memory and {:.1f} in the second level's cache on one thread, "
      "{:.1f} and {:.1f} on {}\n\n{}",
      bandwidth.memory_one, bandwidth.cache_one, bandwidth.memory, bandwidth.cache, bandwidth.threads,
      table.text());
}

ordered_json json_of(const Bandwidth& bandwidth) {
  return {{"threads", bandwidth.threads},
          {"memory_gb_per_s_one_thread", bandwidth.memory_one},
          {"memory_gb_per_s", bandwidth.memory},
          {"cache_gb_per_s_one_thread", bandwidth.cache_one},
          {"cache_gb_per_s", bandwidth.cache}};
}

ordered_json json_of(const Table1Row& row) {
  const bool measured = row.step_ms.has_value();
  const PaperTimes paper = paper_times(row.method, row.bodies);
  return {
      {"bodies", row.bodies},
      {"method", row.method},
      {"model", or_null(row.model)},
      {"threads", row.threads},
      {"step_ms", or_null(row.step_ms)},
      {"collision_ms", or_null(row.collision_ms)},
      {"response_ms", or_null(row.response_ms)},
      {"rest_ms", or_null(row.rest_ms)},
      {"awake", measured ? ordered_json(row.awake) : ordered_json(nullptr)},
      {"state_hash", measured ? ordered_json(fmt::format("{:016x}", row.state_hash)) : ordered_json(nullptr)},
      {"bytes_per_body", measured ? positive_or_null(row.bytes_per_body) : ordered_json(nullptr)},
      {"level_bytes_per_body", measured ? positive_or_null(row.level_bytes_per_body) : ordered_json(nullptr)},
      {"bytes_moved_per_body", measured ? positive_or_null(row.bytes_moved_per_body) : ordered_json(nullptr)},
      {"moved_gb_per_s", or_null(row.moved_gb_per_s)},
      {"share_of_memory_bandwidth", or_null(row.share_of_memory)},
      {"share_of_cache_bandwidth", or_null(row.share_of_cache)},
      {"broad_phase", row.hash_space ? ordered_json("hash") : ordered_json(nullptr)},
      {"times_less_than_full_plain", or_null(row.times_less_than_full_plain)},
      {"times_less_than_spheres7", or_null(row.times_less_than_spheres7)},
      {"times_less_than_sphere", or_null(row.times_less_than_sphere)},
      {"paper_step_ms", positive_or_null(paper.step_ms)},
      {"paper_collision_ms", positive_or_null(paper.collision_ms)},
      {"paper_response_ms", positive_or_null(paper.response_ms)},
      {"reason", or_null(row.left_out)}};
}

ordered_json json_of(std::span<const Table1Row> rows) {
  ordered_json json = {{"rows", ordered_json::array()}};
  for (const Table1Row& row : rows) json["rows"].push_back(json_of(row));
  return json;
}

}  // namespace lodestone
