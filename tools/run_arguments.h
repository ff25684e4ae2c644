// The arguments of commands that run a scene.
#pragma once

#include <filesystem>
#include <string>

#include "scenes/runner.h"
#include "scenes/scene_file.h"
#include "tools/command.h"
#include "tools/progress.h"

namespace lodestone {

struct RunArguments {
  std::filesystem::path scene;
  SceneLoadSettings loading;
  RunSettings running;
  std::string step;  ///< empty: the scene's
  bool no_cache = false;
};

/// Adds --steps, --dt, --seed, --threads, --level, --model, --budget-ms, --budget-work, --full-within-m,
/// --audit-ms, --mesh-path, --untrusted and --no-cache to `command`. `arguments` outlives the parsing.
void add_run_arguments(Command& command, RunArguments& arguments);

/// Those of them that were given and that a result depends on, as a shell takes them: " --steps 100 --seed
/// 2".
std::string options_of(const RunArguments& arguments);

/// The settings that the arguments ask for, with progress and the measuring of signatures shown on `line`,
/// which outlives the run.
RunSettings run_settings(const RunArguments& arguments, ProgressLine& line);

}  // namespace lodestone
