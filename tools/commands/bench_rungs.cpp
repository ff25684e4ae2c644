#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tools/bench/rungs_bench.h"
#include "tools/commands.h"
#include "tools/progress.h"
#include "tools/results.h"
#include "tools/text_table.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

struct BenchRungsArguments {
  RungsSettings bench;
  std::string shape;
  ResultArguments results;
};

double height_change_percent(const RungsHeap& heap) {
  return 100.0 * (heap.mean_height_after_m / heap.mean_height_before_m - 1.0);
}

std::string text_of(const RungsHeap& heap) {
  TextTable table({"change", "bodies", "median mm", "99 % mm", "99.9 % mm", "most mm", "unseen",
                   "unexplained 99.9 %", "most", "others mm", "energy/mgR", "woken", "put off"});
  for (const RungsRow& row : heap.rows)
    table.add_row({row.change, fmt::format("{}", row.changes), fmt::format("{:.3f}", row.p50_mm),
                   fmt::format("{:.2f}", row.p99_mm), fmt::format("{:.2f}", row.p999_mm),
                   fmt::format("{:.2f}", row.max_mm),
                   row.change == "none" ? "-"
                   : is_unseen(row)     ? "yes"
                                        : "NO",
                   fmt::format("{:.2f}", row.unexplained_p999_mm),
                   fmt::format("{:.2f}", row.unexplained_max_mm), fmt::format("{:.2f}", row.others_max_mm),
                   fmt::format("{:.2g}", row.energy_rise), fmt::format("{}", row.woken),
                   fmt::format("{}", row.put_off)});
  return fmt::format(
      "{} x {}, {}: {} asleep before, {} after; mean height {:.4f} m before, {:.4f} m after ({:+.2f} "
      "%)\n\n{}\n",
      heap.bodies, heap.shape, heap.kept_awake ? "kept awake" : "asleep", heap.asleep_before,
      heap.asleep_after, heap.mean_height_before_m, heap.mean_height_after_m, height_change_percent(heap),
      table.text());
}

ordered_json json_of(const RungsHeap& heap, const RungsRow& row) {
  return {{"shape", heap.shape},
          {"bodies", heap.bodies},
          {"heap", heap.kept_awake ? "awake" : "asleep"},
          {"asleep_before", heap.asleep_before},
          {"asleep_after", heap.asleep_after},
          {"mean_height_before_m", heap.mean_height_before_m},
          {"mean_height_after_m", heap.mean_height_after_m},
          {"change", row.change},
          {"changes", row.changes},
          {"p50_mm", row.p50_mm},
          {"p99_mm", row.p99_mm},
          {"p999_mm", row.p999_mm},
          {"max_mm", row.max_mm},
          {"unseen", is_unseen(row)},
          {"unexplained_p999_mm", row.unexplained_p999_mm},
          {"unexplained_max_mm", row.unexplained_max_mm},
          {"others_max_mm", row.others_max_mm},
          {"energy_rise_over_mgr", row.energy_rise},
          {"woken", row.woken},
          {"put_off", row.put_off}};
}

bool is_seen(const RungsHeap& heap) {
  return std::ranges::any_of(heap.rows,
                             [](const RungsRow& row) { return row.change != "none" && !is_unseen(row); });
}

std::string text_of(const std::vector<RungsHeap>& heaps) {
  std::string text;
  for (const RungsHeap& heap : heaps) text += text_of(heap);
  return text;
}

// What is measured.
std::string text_of(const RungsSettings& bench) {
  return fmt::format(
      "heaps that came to rest at support, taken up and down the rungs {} times, {} frames of 1/60 s after "
      "each change, at most {} bodies full at a time\n"
      "mm: of each body that changed, the worst frame's move beyond v dt, |dx - v dt| - g dt^2 / 2; "
      "unseen: 99.9 % within 5 mm, all within 20 mm\n"
      "unexplained: beyond any velocity between the frame's first and last; others: bodies that did not "
      "change; energy: the heap's greatest rise after a change\n"
      "none: as many frames without a change\n\n",
      bench.rounds, bench.frames, bench.slice);
}

ExitCode run_rungs(BenchRungsArguments arguments) {
  if (!arguments.shape.empty()) arguments.bench.shapes = {arguments.shape};
  const std::vector<RungsHeap> heaps = with_progress(arguments.bench, bench_rungs);
  ordered_json json = {{"rounds", arguments.bench.rounds},
                       {"frames", arguments.bench.frames},
                       {"slice", arguments.bench.slice},
                       {"rows", ordered_json::array()}};
  for (const RungsHeap& heap : heaps)
    for (const RungsRow& row : heap.rows) json["rows"].push_back(json_of(heap, row));
  print_table(arguments.results, json, json_of(RungsHeap{}, RungsRow{}),
              text_of(arguments.bench) + text_of(heaps));
  return std::ranges::any_of(heaps, is_seen) ? ExitCode::check_failed : ExitCode::done;
}

}  // namespace

void add_bench_rungs_command(Command& bench) {
  auto [command, arguments] = bench.add<BenchRungsArguments>(
      "rungs", "what is seen when a heap, asleep or awake, is taken up and down the rungs", run_rungs);
  RungsSettings& settings = arguments.bench;
  command.add_option("--shape", arguments.shape, "a heap of these only").one_of({"bunny", "l"});
  command.add_option("--bodies", settings.bodies, "of each heap, instead of 1,000 bunnies and 300 L-shapes")
      .within(1, 100'000);
  command.add_option("--rounds", settings.rounds, "times that all rungs are gone through").within(1, 10'000);
  command.add_option("--frames", settings.frames, "of 1/60 s, watched after each change").within(1, 10'000);
  command.add_option("--slice", settings.slice, "bodies that are full at a time").within(1, 100'000);
  command.add_option("--seed", settings.seed, "of the heaps");
  add_table_arguments(command, arguments.results);
  command.add_footer(
      "Exit code 1 where a change is seen: more than one in a thousand above 5 mm, or one above 20 mm.");
}

}  // namespace lodestone
