// What a run of a scene showed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "reference/geometry.h"
#include "reference/simulation_error.h"
#include "scenes/budget_figures.h"
#include "scenes/time_summary.h"

namespace lodestone {

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
  /// Ended before its last step: by `stop`, by a file that could not be written, or by ODE.
  bool incomplete = false;
  std::string write_error;                 ///< the first file that could not be written, and why; empty: none
  std::optional<SimulationError> failure;  ///< ODE gave up in the step after the last that counts
  std::optional<BudgetFigures> budget;     ///< none without a budget
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

}  // namespace lodestone
