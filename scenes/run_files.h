// What a run leaves in its folder: what `lodestone view` plays, a trajectory for viewers of glTF, and a row
// for each step.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scenes/playback.h"
#include "scenes/run_result.h"
#include "scenes/run_settings.h"
#include "scenes/step_csv.h"
#include "scenes/trajectory.h"

namespace lodestone {

/// What a run writes, and where; an empty one it does not. A second future's is there where there is none,
/// too.
struct RunPlaces {
  std::filesystem::path playback, fork_playback, trajectory, steps, recording;
};
RunPlaces places_of(const Scene& scene, const RunSettings& settings);

/// A place that is full ends the run, not the program: what there is so far is kept, and fault() says why.
class RunFiles {
 public:
  /// Makes `settings.out` and begins the table; nothing where it is empty. Of a second future the playback
  /// alone. Throws InputError where they cannot be written. `scene` outlives it.
  RunFiles(const Scene& scene, const RunSettings& settings);

  /// Without the frames so far: they are another future's.
  void begin_anew(int from_step);
  /// The bodies after `step`, where it has a frame; before a first step nobody has a rung yet, and the first
  /// frame gets that of the first step.
  void record(const Manager& manager, std::span<const BodyId> bodies, const RunSample& sample, int step,
              double dt_s);
  void add_row(const StepReport& report, double time_s, const RunSample& sample);
  /// The last frame, whatever every_n_steps is, and all files; `result` receives their names, and has the
  /// times of the steps.
  void finish(const Manager& manager, std::span<const BodyId> bodies, const RunSample& sample, int end_step,
              double dt_s, const std::string& label, RunResult& result);

  bool has_playback() const { return !playback_.empty(); }
  /// The first file that could not be written, and why; empty: none.
  const std::string& fault() const { return fault_; }
  /// Whether `write_file` found room.
  template <class WriteFile>
  bool write(WriteFile write_file) {
    try {
      write_file();
      return true;
    } catch (const std::exception& error) {  // too little memory to put it together, too
      if (fault_.empty()) fault_ = error.what();
      return false;
    }
  }

 private:
  void add_frame(const Manager& manager, std::span<const BodyId> bodies, const RunSample& sample,
                 double time_s);
  std::span<const BodyStatus> read_statuses(const Manager& manager, std::span<const BodyId> bodies);

  const Scene& scene_;
  std::filesystem::path playback_, trajectory_file_, csv_file_;  // empty: not written
  std::optional<StepCsv> csv_;
  Trajectory trajectory_;
  std::vector<BodyStatus> statuses_;  // of a frame
  int from_step_ = 0;
  std::string fault_;
};

}  // namespace lodestone
