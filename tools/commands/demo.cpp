#include "tools/demo/demo.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "reference/error.h"
#include "reference/output_file.h"
#include "scenes/run_files.h"
#include "tools/commands.h"
#include "tools/compare/drop_report.h"
#include "tools/pages/page.h"
#include "tools/report/machine.h"
#include "tools/report/report.h"
#include "tools/results.h"
#include "tools/run_arguments.h"
#include "tools/run_report.h"

namespace lodestone {
namespace {

struct DemoArguments {
  RunArguments run;
  std::filesystem::path budget_scene, steps_csv, report;
  int trials = 300;
  ResultArguments results;
};

Provenance provenance_of(const DemoArguments& arguments) {
  const std::string budgets = arguments.budget_scene.empty()
                                  ? ""
                                  : fmt::format(" --budget-scene {}", arguments.budget_scene.string());
  return {.commands = {fmt::format("build/lodestone demo {}{}{} --trials {}", arguments.run.scene.string(),
                                   options_of(arguments.run), budgets, arguments.trials)},
          .commit = program_commit(),
          .machine = describe_machine(),
          .date = today(),
          .fresh = true};
}

void save_report(const DemoResult& result, const DemoArguments& arguments, const Progress& progress) {
  const Provenance made = provenance_of(arguments);
  const Material& material = result.drop.material;
  const FreshResults fresh = {
      .material = fmt::format("restitution {:g}, friction {:g}", material.restitution, material.friction),
      .scores = {made, score_rows_of(result.errors)},
      .steps = {made, step_rows_of(result)},
      .levels = {made, level_rows_of(result)}};
  save_page(arguments.report,
            make_report(gather_report(
                {.threads = arguments.run.running.threads, .progress = progress, .fresh = fresh})));
}

void check_apart_from_run(const DemoArguments& arguments, const Scene& scene) {
  const RunPlaces places = places_of(scene, arguments.run.running);
  for (const std::filesystem::path& file : {arguments.steps_csv, arguments.report})
    for (const std::filesystem::path& of_run : {places.playback, places.trajectory, places.steps})
      if (!file.empty() && is_one_file(file, of_run))
        throw_input_error(file.string(), "a file that the mixed run writes into the folder of --out",
                          "another one");
}

ExitCode run_demo_command(DemoArguments& arguments) {
  if (arguments.report.empty()) arguments.report = arguments.run.running.out / "report.html";
  const Scene scene = load_scene(arguments.run.scene, arguments.run.loading);
  check_apart_from_run(arguments, scene);
  std::optional<Scene> budget_scene;
  if (!arguments.budget_scene.empty())
    budget_scene = load_scene(arguments.budget_scene, arguments.run.loading);
  DemoResult result;
  {
    ProgressLine line;
    const RunSettings settings = run_settings(arguments.run, line);
    result = run_demo(scene, settings, arguments.trials, line.function());
    result.scene = arguments.run.scene.string();
    result.budget_scene = arguments.budget_scene.string();
    if (budget_scene) result.budgets = run_budgets(*budget_scene, settings, line.function());
  }
  if (!arguments.steps_csv.empty()) {
    const auto rows = step_rows_of(result);
    save_csv(rows, rows.front(), arguments.steps_csv);
  }
  nlohmann::ordered_json json = json_of(result);
  json["report"] = arguments.report.string();
  print_results(arguments.results, json,
                fmt::format("{}: {}", arguments.run.scene.string(), text_of(result)));
  std::fflush(stdout);  // results first: a report that cannot be written must not take them along
  {
    ProgressLine line;
    save_report(result, arguments, line.function());
  }
  if (!arguments.results.json)
    fmt::print("The report is in {}, for any browser\n", arguments.report.string());
  return exit_code_of(result.mixed);
}

}  // namespace

void add_demo_command(Command& program) {
  auto [command, arguments] = program.add<DemoArguments>(
      "demo", "one scene at every level: what a step costs, and what that costs in accuracy",
      run_demo_command);
  arguments.run.running.out = "out";
  command.add_option("SCENE", arguments.run.scene, "a YAML file, such as scenes/bunnies.yaml").required();
  add_run_arguments(command, arguments.run);
  command.add_option("--trials", arguments.trials, "single drops for the accuracy").within(2, 1'000'000);
  command.add_option("--budget-scene", arguments.budget_scene,
                     "another YAML file, run under budgets of 4, 8 and 16 ms, such as scenes/heap.yaml");
  command.add_option("--out", arguments.run.running.out, "folder for the trajectory").written_into();
  command
      .add_option("--steps-csv", arguments.steps_csv,
                  "file for every step of the mixed run and of those under a budget")
      .written();
  add_json_argument(command, arguments.results);
  command
      .add_option("--report", arguments.report,
                  "file for the page of HTML; else report.html beside the trajectory")
      .written();
}

}  // namespace lodestone
