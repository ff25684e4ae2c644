#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "tools/commands.h"
#include "tools/demo.h"
#include "tools/run_arguments.h"
#include "tools/run_report.h"

namespace lodestone {
namespace {

struct Arguments {
  RunArguments run;
  int trials = 300;
  bool json = false;
};

ExitCode demo(const Arguments& arguments) {
  const Scene scene = load_scene(arguments.run.scene, arguments.run.loading);
  DemoResult result;
  {
    ProgressLine line;
    result = run_demo(scene, run_settings(arguments.run, line), arguments.trials, line.function());
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
  command->add_option("--out", arguments->run.running.out, "folder for the trajectory")->capture_default_str();
  command->add_flag("--json", arguments->json, "one JSON object on stdout");
  command->callback([arguments, &exit_code] { exit_code = demo(*arguments); });
}

}  // namespace lodestone
