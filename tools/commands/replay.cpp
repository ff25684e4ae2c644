#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tools/commands.h"
#include "tools/results.h"
#include "tools/run_arguments.h"

namespace lodestone {
namespace {

struct ReplayArguments {
  RunArguments run;
  std::filesystem::path recording;
  ResultArguments results;
};

ExitCode replay(const ReplayArguments& arguments) {
  const Scene scene = load_scene(arguments.run.scene, arguments.run.loading);
  ReplayResult result;
  {
    ProgressLine line;
    result = replay_scene(scene, run_settings(arguments.run, line), arguments.recording);
  }
  print_results(arguments.results, {{"steps", result.steps}, {"same", result.same}, {"text", result.text}},
                fmt::format("{}: {}\n", arguments.recording.string(), result.text));
  return result.same ? ExitCode::done : ExitCode::check_failed;
}

}  // namespace

void add_replay_command(Command& program) {
  auto [command, arguments] = program.add<ReplayArguments>(
      "replay",
      "do again what `run --record` recorded, and name the first step and body that come out otherwise",
      replay);
  command.add_option("FILE", arguments.recording, "a recording").required();
  command
      .add_option("SCENE", arguments.run.scene,
                  "the YAML file that it was made with; the options are those of that run, too")
      .required();
  add_run_arguments(command, arguments.run);
  add_json_argument(command, arguments.results);
}

}  // namespace lodestone
