// Runs a scene headless and says what happened.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scenes/scene.h"

namespace lodestone {

struct RunSettings {
  std::optional<int> steps = {};               ///< else the scene's
  std::optional<double> dt_s = {};             ///< else the scene's; (0, 0.1]
  std::optional<StatisticalModel> model = {};  ///< else the scene's
  LevelChoice level = LevelChoice::automatic;  ///< other than automatic: forces every body
  int threads = 1;
  std::filesystem::path out = {};              ///< folder for the trajectory and steps.csv; empty: write nothing
  SignatureFunction signatures = {};
  std::function<void(int step, int steps)> progress = {};
};

/// Median and tail of a sample of milliseconds.
struct TimeSummary { double p50 = 0, p95 = 0, p99 = 0, mean = 0, max = 0; };

/// Percentiles are interpolated between the nearest ranks; all 0 for no sample.
TimeSummary summarize(std::span<const double> sample_ms);

/// One of the scene's `check:` lines, evaluated.
struct CheckResult {
  std::string name;
  double value = 0, bound = 0;
  bool pass = true;
  bool decided = true;  ///< false where the run ended before the check could fail or pass; `pass` is true then
};

struct RunResult {
  int steps = 0, bodies = 0;
  std::uint64_t state_hash = 0;
  TimeSummary step_ms;
  std::vector<StepReport> reports;             ///< one per step
  std::int64_t transitions = 0, promotions = 0;
  double max_penetration_m = 0;                ///< deepest hull vertex below a ground plane, over the run
  double energy_start_j = 0, energy_max_j = 0; ///< kinetic and potential, all bodies
  bool finite = true;                          ///< no NaN or infinity at any step; the run ends at the first
  std::vector<RigidState> states;              ///< at the end, in the scene's order
  std::vector<CheckResult> checks;
  std::filesystem::path trajectory, csv;       ///< written files, or empty
  const StepReport& last() const { return reports.back(); }
};

/// Runs at least one step. Throws InputError for settings out of range or an `out` that cannot be written, before anything is simulated.
RunResult run_scene(const Scene& scene, const RunSettings& settings = {});

}  // namespace lodestone
