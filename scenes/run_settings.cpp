#include "scenes/run_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "reference/argument_error.h"
#include "reference/output_file.h"
#include "scenes/run_files.h"
#include "scenes/scene_sections.h"
#include "scenes/trajectory.h"

namespace lodestone {
namespace {

[[noreturn]] void refuse(const std::string& name, const std::string& found, const std::string& expected) {
  throw ArgumentError(fmt::format("{}: found {}, expected {}", name, found, expected));
}

void check_policy(const RunSettings& settings) {
  if (settings.budget_ms && settings.budget_work) refuse("budget_ms and budget_work", "both", "one of them");
  for (const auto& [name, budget] :
       {std::pair("budget_ms", settings.budget_ms), {"budget_work", settings.budget_work}})
    if (budget && !(*budget > 0 && std::isfinite(*budget)))
      refuse(name, fmt::to_string(*budget), "a number above 0");
  if (settings.full_within_m && (settings.budget_ms || settings.budget_work))
    refuse("full_within_m", "it beside a budget", "one of them");
  if (settings.full_within_m && !(*settings.full_within_m >= 0))
    refuse("full_within_m", fmt::to_string(*settings.full_within_m), "a number from 0 on");
}

void check_fork(const Scene& scene, int steps, const RunSettings& settings) {
  if (*settings.fork_step < 1 || *settings.fork_step >= steps)
    refuse("fork", fmt::to_string(*settings.fork_step),
           fmt::format("a step from 1 to {}, before the run's last", steps - 1));
  if (!scene.joints.empty()) refuse("fork", "a scene with joints", "none: a snapshot knows nothing of them");
  if (!settings.record.empty()) refuse("fork", "a recording beside it", "one of them");
  if (settings.level == LevelChoice::automatic && !settings.model && !settings.budget_ms &&
      !settings.budget_work && !settings.full_within_m)
    refuse("fork", "nothing that the second future has otherwise",
           "a level, a model, a budget or full_within_m");
}

void check_trajectory(const Scene& scene, int steps) {
  const int every = scene.output.every_n_steps, frames = steps / every + (steps % every != 0) + 1,
            most = max_trajectory_frames(int(scene.bodies.size()));
  if (frames > most)
    throw InputError(fmt::format(
        "{}: output.every_n_steps: found {} ({} frames of {} bodies), expected at least {} (a "
        ".glb holds 4 GB)",
        scene.file.string(), every, frames, scene.bodies.size(), steps / std::max(1, most - 1) + 1));
}

// Each file that it writes must leave what it reads, and the others, as they are.
void check_places(const Scene& scene, const RunSettings& settings) {
  const RunPlaces places = places_of(scene, settings);
  std::vector<std::filesystem::path> taken = scene.mesh_files;
  taken.push_back(scene.file);
  const std::size_t read = taken.size();
  for (const std::filesystem::path& file :
       {places.playback, places.fork_playback, places.trajectory, places.steps, places.recording}) {
    if (file.empty()) continue;
    for (std::size_t i = 0; i < taken.size(); ++i)
      if (is_one_file(file, taken[i]))
        throw_input_error(file.string(),
                          i < read ? "a file that the scene is made of" : "a file that the run writes, too",
                          "one of its own for what the run writes");
    taken.push_back(file);
  }
}

}  // namespace

std::string text_of(const RunProgress& p) {
  return fmt::format("step {} of {}: {} full, {} support, {} tables, {} asleep", p.step, p.steps, p.full,
                     p.support, p.tables, p.asleep);
}

void check_settings(const Scene& scene, int steps, double dt_s, const RunSettings& settings) {
  if (steps < 1) refuse("steps", fmt::to_string(steps), "at least 1");
  if (!(dt_s > 0 && dt_s <= 0.1)) refuse("dt", fmt::format("{} s", dt_s), "a number in (0, 0.1]");
  check_policy(settings);
  if (settings.threads < 1) refuse("threads", fmt::to_string(settings.threads), "at least 1");
  if (!settings.record.empty() && !scene.joints.empty())
    throw InputError(fmt::format(
        "{}: found joints in a scene to be recorded, expected none: a recording knows nothing of them",
        scene.file.string()));
  if (settings.fork_step) check_fork(scene, steps, settings);
  if (!settings.out.empty()) check_trajectory(scene, steps);
  check_places(scene, settings);
}

std::string text_of_choice(const RunSettings& settings) {
  std::vector<std::string> parts;
  if (settings.level != LevelChoice::automatic)
    parts.push_back(fmt::format("level {}", name_of(settings.level)));
  if (settings.model) parts.push_back(fmt::format("model {}", name_of(rung_of(*settings.model))));
  if (settings.budget_ms) parts.push_back(fmt::format("a budget of {:g} ms", *settings.budget_ms));
  if (settings.budget_work)
    parts.push_back(fmt::format("a budget of {:g} work units", *settings.budget_work));
  if (settings.full_within_m) parts.push_back(fmt::format("full within {:g} m", *settings.full_within_m));
  return parts.empty() ? "as the scene says" : fmt::format("{}", fmt::join(parts, ", "));
}

}  // namespace lodestone
