// Runs a scene headless and says what happened.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "scenes/budget_figures.h"
#include "scenes/scene.h"
#include "scenes/time_summary.h"

namespace lodestone {

struct RunSettings {
  std::optional<int> steps = {};               ///< else the scene's
  std::optional<double> dt_s = {};             ///< else the scene's; (0, 0.1]
  std::optional<StatisticalModel> model = {};  ///< else the scene's
  LevelChoice level = LevelChoice::automatic;  ///< other than automatic: forces every body
  std::optional<double> budget_ms = {}, budget_work = {};  ///< else the scene's policy; at most one of them, positive
  std::optional<double> full_within_m = {};    ///< else the scene's policy; instead of a budget, ≥ 0: policy distance with it
  std::optional<double> audit_ms = {};         ///< else the scene's
  int threads = 1;
  std::filesystem::path out = {};              ///< folder for the trajectory and steps.csv; empty: write nothing
  std::filesystem::path record = {};           ///< file for a recording (lod/record.h) of what is done to the bodies; empty: none
  SignatureFunction signatures = {};
  std::function<void(int step, int steps)> progress = {};
};

/// One of the scene's `check:` lines, evaluated.
struct CheckResult {
  std::string name;
  double value = 0, bound = 0;
  bool pass = true;
  bool decided = true;  ///< false where the run ended before the check could fail or pass; `pass` is true then
};

/// Full bodies whose centre of mass is in the picture (scenes/camera.h) of the scene's first viewpoint, of each step that ends half a second
/// after the start or later.
struct PictureFigures { int min_full = 0; double mean_full = 0; };

struct RunResult {
  int steps = 0, bodies = 0;
  std::uint64_t state_hash = 0;
  TimeSummary step_ms;                         ///< without signature_seconds
  TimeSummary processor_ms;                    ///< the same in processor time of the calling thread
  double signature_seconds = 0;                ///< spent on loading or measuring signatures when bodies first needed them
  std::vector<StepReport> reports;             ///< one per step
  std::optional<BudgetFigures> budget;         ///< none without a budget
  std::optional<PictureFigures> in_picture;    ///< none without a viewpoint, or where the run ended before
  std::int64_t transitions = 0, promotions = 0;
  double max_penetration_m = 0;                ///< deepest hull vertex below a ground plane, over the run
  double max_tables_penetration_m = 0;         ///< the same of bodies at `tables` and of those that came from there and were not awake for 30 steps since
  double energy_start_j = 0, energy_max_j = 0; ///< kinetic and potential, all bodies
  bool finite = true;                          ///< no NaN or infinity at any step; the run ends at the first
  std::vector<RigidState> states;              ///< at the end, in the scene's order
  std::vector<CheckResult> checks;
  std::filesystem::path trajectory, csv;       ///< written files, or empty
  const StepReport& last() const { return reports.back(); }
};

/// Runs at least one step. Throws InputError for settings out of range or an `out` that cannot be written, before anything is simulated.
RunResult run_scene(const Scene& scene, const RunSettings& settings = {});

/// Does again what a run of `scene` with the same settings recorded. Throws InputError for a file that cannot be read, that is no recording, or of another scene.
ReplayResult replay_scene(const Scene& scene, const RunSettings& settings, const std::filesystem::path& recording);

}  // namespace lodestone
