// Runs a scene headless and says what happened.
#pragma once

#include <filesystem>
#include <memory>
#include <utility>

#include "scenes/run_result.h"
#include "scenes/run_settings.h"

namespace lodestone {

/// ODE gave up in a step of a run, of its second future where that is the one.
class FailedRun : public SimulationError {
 public:
  /// `result` has the failure.
  explicit FailedRun(RunResult result)
      : SimulationError(*result.failure), result_(std::make_shared<const RunResult>(std::move(result))) {}
  /// What there is of the steps before it, its files written.
  const RunResult& result() const { return *result_; }

 private:
  std::shared_ptr<const RunResult> result_;  // an exception is copied
};

/// Runs at least one step. Throws InputError (ArgumentError for settings out of range) for what cannot be run
/// and for an `out` that cannot be written, before anything is simulated, and FailedRun where ODE gives up. A
/// place that is full later ends the run: what there is so far is returned, with `write_error`.
RunResult run_scene(const Scene& scene, const RunSettings& settings = {});

/// Does again what a run of `scene` with the same settings recorded. Throws InputError for a file that cannot
/// be read, that is no recording, or of another scene.
ReplayResult replay_scene(const Scene& scene, const RunSettings& settings,
                          const std::filesystem::path& recording);

}  // namespace lodestone
