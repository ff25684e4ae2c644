#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tools/commands.h"
#include "tools/interrupt.h"
#include "tools/results.h"
#include "tools/run_arguments.h"
#include "tools/run_report.h"
#include "tools/scene_signatures.h"
#include "tools/terminal.h"

namespace lodestone {
namespace {

struct RunCommandArguments {
  RunArguments run;
  ResultArguments results;
};

ExitCode run(const RunCommandArguments& arguments) {
  catch_interrupts();
  const Scene scene = load_scene(arguments.run.scene, arguments.run.loading);
  RunResult result;
  {
    ProgressLine line;
    RunSettings settings = run_settings(arguments.run, line);
    settings.stop = is_interrupted;
    fetch_signatures(scene, settings);
    try {
      result = run_scene(scene, settings);
    } catch (const FailedRun& failed) {
      result = failed.result();
    }
  }
  print_results(arguments.results, json_of(result),
                fmt::format("{}: {} bodies, {} steps\n{}", arguments.run.scene.string(), result.bodies,
                            result.steps, text_of(result)));
  if (!result.write_error.empty())
    write_stderr(fmt::format("lodestone: {}\n", printable(result.write_error)));
  if (result.failure) write_stderr(fmt::format("lodestone: {}\n", printable(result.failure->what())));
  return exit_code_of(result);
}

}  // namespace

void add_run_command(Command& program) {
  auto [command, arguments] =
      program.add<RunCommandArguments>("run", "run a scene without a window and say what happened", run);
  command.add_option("SCENE", arguments.run.scene, "a YAML file").required();
  add_run_arguments(command, arguments.run);
  command
      .add_option("--out", arguments.run.running.out,
                  "folder for run.play, which `lodestone view` plays, the trajectory (.glb) and the "
                  "report of each step (.csv)")
      .written_into();
  command.add_option("--fork", arguments.run.running.fork_step,
                     "after this step the world goes on twice: as the scene says, and with --level, "
                     "--model, --budget-… or --full-within-m, which are then for this second future alone");
  command
      .add_option("--record", arguments.run.running.record,
                  "file for a recording, which `lodestone replay` does again")
      .written();
  add_json_argument(command, arguments.results);
}

}  // namespace lodestone
