#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tools/bench/transitions_bench.h"
#include "tools/commands.h"
#include "tools/interrupt.h"
#include "tools/results.h"
#include "tools/run_arguments.h"
#include "tools/scene_signatures.h"
#include "tools/text_table.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

struct BenchTransitionsArguments {
  RunArguments run;
  double from_s = 0.0;
  ResultArguments results;
};

// Null for a figure of which there is no sample.
ordered_json json_of(const MovesBeyondMotion& moves) {
  const auto seen = [&](double figure) {
    return or_null(moves.moves > 0 ? std::optional(figure) : std::nullopt);
  };
  return {{"moves", moves.moves},
          {"p50_px", seen(moves.p50_px)},
          {"p99_px", seen(moves.p99_px)},
          {"max_px", seen(moves.max_px)},
          {"within_pixel", seen(moves.within_pixel)}};
}

ordered_json json_of(const OverlapsAtPromotion& overlaps) {
  const auto seen = [&](double figure) {
    return or_null(overlaps.promotions > 0 ? std::optional(figure) : std::nullopt);
  };
  return {{"promotions", overlaps.promotions},
          {"p50", seen(overlaps.p50)},
          {"p99", seen(overlaps.p99)},
          {"max", seen(overlaps.max)}};
}

ordered_json json_of(const TransitionFigures& figures) {
  return {
      {"changes", figures.changes},
      {"changed", json_of(figures.changed)},
      {"others", json_of(figures.others)},
      {"overlap_over_size",
       {{"bodies", json_of(figures.with_bodies)}, {"ground", json_of(figures.with_ground)}}},
      {"energy", {{"gained_j", figures.gained_j}, {"net_j", figures.net_j}, {"scene_j", figures.scene_j}}},
      {"unseen", is_unseen(figures)}};
}

std::vector<std::string> cells_of(const char* name, const MovesBeyondMotion& of) {
  if (of.moves == 0) return {name, "0", "-", "-", "-", "-"};
  return {name,
          fmt::format("{}", of.moves),
          fmt::format("{:.3f}", of.p50_px),
          fmt::format("{:.3f}", of.p99_px),
          fmt::format("{:.2f}", of.max_px),
          fmt::format("{:.2f} %", 100 * of.within_pixel)};
}

std::vector<std::string> cells_of(const char* name, const OverlapsAtPromotion& of) {
  if (of.promotions == 0) return {name, "0", "-", "-", "-"};
  return {name, fmt::format("{}", of.promotions), fmt::format("{:.2f}", 100 * of.p50),
          fmt::format("{:.2f}", 100 * of.p99), fmt::format("{:.2f}", 100 * of.max)};
}

std::string text_of(const TransitionFigures& figures) {
  TextTable moves({"in the picture", "moves", "median px", "99 % px", "most px", "within 1 px"});
  moves.add_row(cells_of("changed rung", figures.changed));
  moves.add_row(cells_of("others awake", figures.others));
  TextTable overlaps({"overlap at promotion", "promotions", "median %", "99 %", "most %"});
  overlaps.add_row(cells_of("with bodies", figures.with_bodies));
  overlaps.add_row(cells_of("with ground", figures.with_ground));
  return fmt::format(
      "{} changes of rung; moves beyond a body's motion in a step, pixels of the viewpoint's picture; "
      "overlap over the body's size where it became full\n\n{}\n{}\n"
      "energy of changed bodies and those beside them in the step of the change: gained {:.4g} J, net {:.4g} "
      "J, of {:.4g} J that the scene loses{}\n",
      figures.changes, moves.text(), overlaps.text(), figures.gained_j, figures.net_j, figures.scene_j,
      figures.scene_j > 0 ? fmt::format(" ({:.4f} %)", 100 * figures.gained_j / figures.scene_j) : "");
}

ExitCode run_transitions(const BenchTransitionsArguments& arguments) {
  const Scene scene = load_scene(arguments.run.scene, arguments.run.loading);
  TransitionFigures figures;
  {
    ProgressLine line;
    RunSettings settings = run_settings(arguments.run, line);
    settings.stop = is_interrupted;
    fetch_signatures(scene, settings);
    figures = bench_transitions(scene, settings, arguments.from_s);
  }
  print_results(arguments.results, json_of(figures),
                fmt::format("{}: {}", arguments.run.scene.string(), text_of(figures)));
  return is_unseen(figures) ? ExitCode::done : ExitCode::check_failed;
}

}  // namespace

void add_bench_transitions_command(Command& bench) {
  auto [command, arguments] =
      bench.add<BenchTransitionsArguments>("transitions",
                                           "what is seen of a scene's changes of rung: moves in pixels, "
                                           "overlap where a body becomes full, energy",
                                           run_transitions);
  command.add_option("SCENE", arguments.run.scene, "a YAML file with a viewpoint").required();
  add_run_arguments(command, arguments.run);
  command.add_option("--from-s", arguments.from_s, "when looking begins, s").within(0.0, 1e6);
  add_json_argument(command, arguments.results);
  command.add_footer(
      "Exit code 1 where a change is seen: more than one in a hundred above 1 px, an overlap above 5 %, or "
      "more energy gained than .1 % of what the scene loses.");
}

}  // namespace lodestone
