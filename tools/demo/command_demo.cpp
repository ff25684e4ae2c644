#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "tools/commands.h"
#include "tools/demo/demo.h"
#include "tools/run_arguments.h"
#include "tools/run_report.h"

namespace lodestone {
namespace {

struct Arguments {
  RunArguments run;
  std::filesystem::path budget_scene;
  int trials = 300;
  bool json = false;
};

ExitCode demo(const Arguments& arguments) {
  const Scene scene = load_scene(arguments.run.scene, arguments.run.loading);
  std::optional<Scene> budget_scene;
  if (!arguments.budget_scene.empty()) budget_scene = load_scene(arguments.budget_scene, arguments.run.loading);
  DemoResult result;
  {
    ProgressLine line;
    const RunSettings settings = run_settings(arguments.run, line);
    result = run_demo(scene, settings, arguments.trials, line.function());
    result.budget_scene = arguments.budget_scene.string();
    if (budget_scene) result.budgets = run_budgets(*budget_scene, settings, line.function());
  }
  if (arguments.json) fmt::print("{}\n", json_of(result).dump(2));
  else fmt::print("{}: {}", arguments.run.scene.string(), text_of(result));
  return exit_code_of(result.mixed);
}

}  // namespace

void add_demo_command(CLI::App& program, ExitCode& exit_code) {
  CLI::App* command = program.add_subcommand("demo", "one scene at every level: what a step costs, and what that costs in accuracy");
  const auto arguments = std::make_shared<Arguments>();
  arguments->run.running.out = "out";
  command->add_option("SCENE", arguments->run.scene, "a YAML file, such as scenes/bunnies.yaml")->required();
  add_run_arguments(*command, arguments->run);
  command->add_option("--trials", arguments->trials, "single drops for the accuracy")->check(CLI::Range(2, 1'000'000))->capture_default_str();
  command->add_option("--budget-scene", arguments->budget_scene, "another YAML file, run under budgets of 4, 8 and 16 ms, such as scenes/heap.yaml");
  command->add_option("--out", arguments->run.running.out, "folder for the trajectory")->capture_default_str();
  command->add_flag("--json", arguments->json, "one JSON object on stdout");
  command->callback([arguments, &exit_code] { exit_code = demo(*arguments); });
}

}  // namespace lodestone
