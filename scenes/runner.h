// Runs a scene headless and says what happened.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scenes/budget_figures.h"
#include "scenes/run_sample.h"
#include "scenes/scene.h"
#include "scenes/time_summary.h"

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

/// One of the scene's `check:` lines, evaluated.
struct CheckResult {
  std::string name;
  double value = 0, bound = 0;
  bool pass = true;
  /// False where the run ended before the check could fail or pass; `pass` is true then.
  bool decided = true;
};

/// Full bodies whose centre of mass is in the picture (scenes/camera.h) of the scene's first viewpoint, of
/// each step that ends half a second after the start or later.
struct PictureFigures {
  int min_full = 0;
  double mean_full = 0;
};

struct ForkedRun;

struct RunResult {
  int steps = 0, bodies = 0;
  std::uint64_t state_hash = 0;
  TimeSummary step_ms;           ///< without signature_seconds
  TimeSummary processor_ms;      ///< the same in processor time of the calling thread
  double signature_seconds = 0;  ///< spent on loading or measuring signatures when bodies first needed them
  StepReport last_report;        ///< of the last step
  StageTimes stage_ms;           ///< summed over the steps
  std::vector<StepReport> reports;        ///< one per step, with keep_steps
  std::vector<double> step_processor_ms;  ///< of each step, with keep_steps or a playback
  bool incomplete = false;  ///< ended before its last step, by `stop` or by a file that could not be written
  std::string write_error;  ///< the first file that could not be written, and why; empty: none
  std::optional<BudgetFigures> budget;       ///< none without a budget
  std::optional<PictureFigures> in_picture;  ///< none without a viewpoint, or where the run ended before
  std::int64_t transitions = 0, promotions = 0;
  double max_penetration_m = 0;  ///< deepest hull vertex in ground planes and boxes, over the run
  /// The same of bodies at `tables` and of those that came from there and were not awake for 30 steps since.
  double max_tables_penetration_m = 0;
  double energy_start_j = 0, energy_max_j = 0, energy_end_j = 0;  ///< kinetic and potential, all bodies
  bool finite = true;              ///< no NaN or infinity at any step; the run ends at the first
  std::vector<RigidState> states;  ///< at the end, in the scene's order
  std::vector<CheckResult> checks;
  std::filesystem::path playback, trajectory, csv;  ///< written files, or empty
  std::shared_ptr<const ForkedRun> fork;            ///< null without fork_step
  const StepReport& last() const { return last_report; }
  double mean_ms(double StageTimes::*stage) const { return stage_ms.*stage / double(steps); }
};

/// The second future of a world.
struct ForkedRun {
  int step = 0;      ///< after which the two differ
  RunResult result;  ///< from there on
  /// Of each step from there on: from where a body is in one future to where it is in the other, mean over
  /// the bodies.
  std::vector<double> mean_distance_m;
};

/// Runs at least one step. Throws InputError (ArgumentError for settings out of range) for what cannot be run
/// and for an `out` that cannot be written, before anything is simulated. A place that is full later ends the
/// run: what there is so far is returned, with `write_error`.
RunResult run_scene(const Scene& scene, const RunSettings& settings = {});

/// Does again what a run of `scene` with the same settings recorded. Throws InputError for a file that cannot
/// be read, that is no recording, or of another scene.
ReplayResult replay_scene(const Scene& scene, const RunSettings& settings,
                          const std::filesystem::path& recording);

}  // namespace lodestone
