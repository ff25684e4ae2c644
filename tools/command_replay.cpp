#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "tools/commands.h"
#include "tools/run_arguments.h"

namespace lodestone {
namespace {

struct Arguments {
  RunArguments run;
  std::filesystem::path recording;
  bool json = false;
};

ExitCode replay(const Arguments& arguments) {
  const Scene scene = load_scene(arguments.run.scene, arguments.run.loading);
  ReplayResult result;
  {
    ProgressLine line;
    result = replay_scene(scene, run_settings(arguments.run, line), arguments.recording);
  }
  if (arguments.json)
    fmt::print(
        "{}\n",
        nlohmann::ordered_json{{"steps", result.steps}, {"same", result.same}, {"text", result.text}}.dump(
            2));
  else
    fmt::print("{}: {}\n", arguments.recording.string(), result.text);
  return result.same ? ExitCode::done : ExitCode::check_failed;
}

}  // namespace

void add_replay_command(CLI::App& program, ExitCode& exit_code) {
  CLI::App* command = program.add_subcommand(
      "replay",
      "do again what `run --record` recorded, and name the first step and body that come out otherwise");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("FILE", arguments->recording, "a recording")->required();
  command
      ->add_option("SCENE", arguments->run.scene,
                   "the YAML file that it was made with; the options are those of that run, too")
      ->required();
  add_run_arguments(*command, arguments->run);
  command->add_flag("--json", arguments->json, "one JSON object on stdout");
  command->callback([arguments, &exit_code] { exit_code = replay(*arguments); });
}

}  // namespace lodestone
