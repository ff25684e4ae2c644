// Runs a scene headless and says what happened.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "scenes/scene.h"

namespace lodestone {

struct RunSettings {
  std::optional<int> steps;
  std::optional<double> dt_s;
  std::optional<StatisticalModel> model;
  LevelChoice level = LevelChoice::automatic;  ///< other than automatic: forces every body
  int threads = 1;
  std::filesystem::path out;                   ///< folder for the trajectory and CSV; empty: write nothing
  SignatureFunction signatures;
  std::function<void(int step, int steps)> progress;
};

/// Median and tail of a sample of milliseconds.
struct TimeSummary { double p50 = 0, p95 = 0, p99 = 0, mean = 0, max = 0; };

/// One of the scene's `check:` lines, evaluated.
struct CheckResult { std::string name; double value = 0, bound = 0; bool pass = true; };

struct RunResult {
  int steps = 0, bodies = 0;
  std::uint64_t state_hash = 0;
  TimeSummary step_ms;
  std::vector<StepReport> reports;             ///< one per step
  std::int64_t transitions = 0, promotions = 0;
  double max_penetration_m = 0;                ///< deepest hull vertex below a ground plane, over the run
  double energy_start_j = 0, energy_max_j = 0; ///< kinetic and potential, all bodies
  bool finite = true;                          ///< no NaN or infinity at any step
  std::vector<CheckResult> checks;
  std::filesystem::path trajectory;            ///< written file, or empty
  const StepReport& last() const { return reports.back(); }
};

RunResult run_scene(const Scene& scene, const RunSettings& settings = {});

}  // namespace lodestone
