#include "scenes/run_files.h"

#include <algorithm>

#include "reference/output_file.h"

namespace lodestone {

RunPlaces places_of(const Scene& scene, const RunSettings& settings) {
  RunPlaces places;
  places.recording = settings.record;
  if (settings.out.empty()) return places;
  places.playback = settings.out / "run.play";
  places.steps = settings.out / "steps.csv";
  places.fork_playback = settings.out / "fork.play";
  if (!scene.output.trajectory.empty()) places.trajectory = settings.out / scene.output.trajectory;
  return places;
}

RunFiles::RunFiles(const Scene& scene, const RunSettings& settings)
    : scene_(scene), trajectory_(int(scene.bodies.size())) {
  if (settings.out.empty()) return;
  std::error_code error;
  std::filesystem::create_directories(settings.out, error);
  if (error) throw_file_error(settings.out, error.value(), "a folder for results");
  const RunPlaces places = places_of(scene, settings);
  playback_ = settings.fork_step ? places.fork_playback : places.playback;
  if (settings.fork_step) return;
  if (std::filesystem::is_regular_file(std::filesystem::symlink_status(places.fork_playback, error)))
    std::filesystem::remove(places.fork_playback, error);  // an earlier run's: `view` would play it with this
  csv_file_ = places.steps, trajectory_file_ = places.trajectory;
  csv_.emplace(csv_file_);
}

void RunFiles::begin_anew(int from_step) {
  trajectory_ = Trajectory(trajectory_.bodies());
  from_step_ = from_step;
}

void RunFiles::record(const Manager& manager, std::span<const BodyId> bodies, const RunSample& sample,
                      int step, double dt_s) {
  if (step == 1 && trajectory_.frames() > 0) trajectory_.set_first_statuses(read_statuses(manager, bodies));
  if ((step - from_step_) % scene_.output.every_n_steps == 0) add_frame(manager, bodies, sample, step * dt_s);
}

void RunFiles::add_frame(const Manager& manager, std::span<const BodyId> bodies, const RunSample& sample,
                         double time_s) {
  if (!has_playback() || !sample.finite) return;
  trajectory_.add_frame(time_s, sample.states, read_statuses(manager, bodies));
}

std::span<const BodyStatus> RunFiles::read_statuses(const Manager& manager, std::span<const BodyId> bodies) {
  statuses_.clear();
  for (const BodyId body : bodies)
    statuses_.push_back({.rung = manager.rung(body),
                         .asleep = manager.asleep(body),
                         .rule = manager.explain(body).rule,
                         .collision_radius_m = float(manager.collision_radius(body))});
  return statuses_;
}

void RunFiles::add_row(const StepReport& report, double time_s, const RunSample& sample) {
  write([&] {
    if (csv_)
      csv_->add(report, time_s, sample.energy_j,
                std::max(sample.max_tables_penetration_m, sample.max_other_penetration_m));
  });
}

void RunFiles::finish(const Manager& manager, std::span<const BodyId> bodies, const RunSample& sample,
                      int end_step, double dt_s, const std::string& label, RunResult& result) {
  add_frame(manager, bodies, sample, end_step * dt_s);
  write([&] {
    if (csv_) csv_->close();
  });
  result.csv = csv_file_;
  const auto save_to = [&](const std::filesystem::path& file, auto save) {
    return !file.empty() && write(save) ? file : std::filesystem::path();
  };
  result.playback = save_to(playback_, [&] {
    save_playback(
        playback_, trajectory_, scene_,
        {.label = label, .from_step = from_step_, .step_ms = result.step_processor_ms, .dt_s = dt_s});
  });
  result.trajectory =
      save_to(trajectory_file_, [&] { save_trajectory(trajectory_file_, trajectory_, scene_); });
}

}  // namespace lodestone
