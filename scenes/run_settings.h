// What is asked for of a run of a scene.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "scenes/run_sample.h"
#include "scenes/scene.h"

namespace lodestone {

/// How far a run is.
struct RunProgress {
  int step = 0, steps = 0;
  int full = 0, support = 0, tables = 0,
      asleep = 0;  ///< bodies after that step; the sleepers are among the others
};
/// "step 120 of 600: 20 full, 300 support, 680 tables, 12 asleep"
std::string text_of(const RunProgress& progress);

/// A step of a run that has just ended.
struct WatchedStep {
  const Manager& manager;
  std::span<const BodyId> bodies;   ///< in the scene's order, as the samples
  const RunSample &before, &after;  ///< the step
  double start_s = 0, dt_s = 0;
  double processor_ms = 0;  ///< of the calling thread, in the step
};

struct RunSettings {
  std::optional<int> steps = {};               ///< else the scene's
  std::optional<double> dt_s = {};             ///< else the scene's; (0, 0.1]
  std::optional<StatisticalModel> model = {};  ///< else the scene's
  LevelChoice level = LevelChoice::automatic;  ///< other than automatic: forces every body
  std::optional<double> budget_ms = {},
                        budget_work = {};  ///< else the scene's policy; at most one of them, positive
  /// Else the scene's policy; instead of a budget, ≥ 0: policy distance with it.
  std::optional<double> full_within_m = {};
  std::optional<double> audit_ms = {};  ///< else the scene's
  int threads = 1;
  /// From the end of this step on the world goes on twice: as the scene says all through, and once more with
  /// level, model, budget and full_within_m of these settings, which are for this second future alone.
  std::optional<int> fork_step = {};
  /// Folder for run.play (scenes/playback.h; fork.play beside it), the trajectory and steps.csv; empty: write
  /// nothing.
  std::filesystem::path out = {};
  /// File for a recording (lod/record.h) of what is done to the bodies; empty: none.
  std::filesystem::path record = {};
  SignatureFunction signatures = {};
  std::function<void(const RunProgress&)> progress = {};
  std::function<void(const WatchedStep&)> watch = {};  ///< of each step, outside of its times
  bool keep_steps = false;  ///< in RunResult::reports and step_processor_ms: 500 bytes a step
  /// Asked before each step but the first: true ends the run there, incomplete.
  std::function<bool()> stop = {};
};

/// Throws ArgumentError for settings out of range or that exclude each other, and InputError for what of
/// `scene` cannot be recorded or kept. `steps` and `dt_s`: of the run, whoever says them.
void check_settings(const Scene& scene, int steps, double dt_s, const RunSettings& settings);

/// What of the levels is not the scene's own choice, in words.
std::string text_of_choice(const RunSettings& settings);

}  // namespace lodestone
