#include "tools/run_arguments.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <map>
#include <thread>

#include "tools/scene_signatures.h"
#include "tools/step_argument.h"

namespace lodestone {
namespace {

const std::map<std::string, LevelChoice> kLevels = {
    {"auto", LevelChoice::automatic}, {"full", LevelChoice::full}, {"statistical", LevelChoice::statistical}};
const std::map<std::string, StatisticalModel> kModels = {{"tables", StatisticalModel::tables}, {"support", StatisticalModel::support}};

int threads_of(int asked) { return asked > 0 ? asked : std::max(1, int(std::thread::hardware_concurrency())); }

}  // namespace

void add_run_arguments(CLI::App& command, RunArguments& arguments) {
  RunSettings& running = arguments.running;
  command.add_option("--steps", running.steps, "instead of the scene's")->check(CLI::Range(1, 100'000'000));
  command.add_option("--dt", arguments.step, "step, s: 0.01 or 1/60, instead of the scene's")->check(find_step_fault, "SECONDS");
  command.add_option("--seed", arguments.loading.seed, "instead of the scene's, for scatters too");
  command.add_option("--threads", running.threads, "of the statistical level; 0: all cores")->check(CLI::Range(0, 4096))->capture_default_str();
  command.add_option_function<std::string>("--level", [&](const std::string& name) { running.level = kLevels.at(name); }, "auto: the scene's policy; else one level for every body")
      ->check(CLI::IsMember({"auto", "full", "statistical"}));
  command.add_option_function<std::string>("--model", [&](const std::string& name) { running.model = kModels.at(name); }, "of the statistical level")
      ->check(CLI::IsMember({"tables", "support"}));
  command.add_option("--mesh-path", arguments.loading.mesh_paths, "folders in which mesh files are looked up")->delimiter(':')->allow_extra_args(false);
}

RunSettings run_settings(const RunArguments& arguments, ProgressLine& line) {
  RunSettings settings = arguments.running;
  settings.threads = threads_of(arguments.running.threads);
  if (!arguments.step.empty()) settings.dt_s = step_of(arguments.step);
  settings.progress = [&line](int step, int steps) { line.show(fmt::format("step {} of {}", step, steps), double(step) / steps); };
  settings.signatures = make_signature_function(line);
  return settings;
}

}  // namespace lodestone
