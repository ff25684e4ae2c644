#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reference/random.h"
#include "tools/bench/case_parts.h"
#include "tools/bench/engine_cases.h"
#include "tools/bench/scene_text.h"
#include "tools/step_argument.h"

namespace lodestone {
namespace {

constexpr double kTop = 1.3;  // m, of the highest body

std::string scene_with(const std::string& dt) {
  return fmt::format("version: 1\nstep: {{dt_s: {}}}\nshapes: {{crate: {{box_m: [0.2, 0.3, 0.4]}}}}\nground: [{{plane: {{normal: [0, 0, 1], offset_m: 0}}}}]\n"
                     "bodies:\n  - {{shape: crate, position_m: [0, 0, 1]}}\n", dt);
}

HardCaseRow unclear_steps() {
  const std::string arguments[] = {"0", "-0.01", "-1/60", "nan", "inf", "-inf", "1e-400", "0.2", "1/0", ""};
  const std::string values[] = {"0", "-0.01", ".nan", ".inf", "-.inf", "0.2", "1", "a"};
  int unclear = 0;
  for (const std::string& text : arguments) unclear += find_step_fault(text).find("found '" + text + "', expected") == std::string::npos;
  std::vector<std::string> scenes;
  for (const std::string& value : values) scenes.push_back(scene_with(value));
  unclear += count_unclear(scenes, "step.dt_s");
  for (const std::string good : {"1e-5", "0.1"}) unclear += !find_step_fault(good).empty() + !scene_error_of(scene_with(good)).empty();
  return {.what = "steps of 0, negative, over 1/10 s or no number, as --dt and in a scene: without a clear error", .value = double(unclear), .bound = 0.0, .unit = "steps"};
}

struct PileRun {
  double top_speed = 0.0, energy_gain = 0.0, lowest = 0.0;  ///< m/s; over that at the start; m, of any centre of mass at the end
};

/// 27 boxes fall into a pile for six seconds.
PileRun run_pile(LevelChoice level, double dt, double seconds) {
  Manager manager = make_unmeasured_manager();
  manager.add_plane(Vec3::UnitZ(), 0.0);
  const auto box = box_of({0.2, 0.2, 0.2});
  std::vector<BodyId> bodies;
  for (int i = 0; i < 27; ++i) {
    RandomStream random(17, i, 0);
    const double shift = i / 9 % 2 == 0 ? 0.0 : 0.19;
    const Vec3 place(0.38 * (i % 3) + shift + random.uniform(-0.01, 0.01), 0.38 * (i / 3 % 3) + shift + random.uniform(-0.01, 0.01), kTop - 0.4 * (2 - i / 9));
    bodies.push_back(manager.add_body({.shape = box, .state = {.position = place, .orientation = random.orientation()}, .level = level}));
  }
  const auto energy = [&] {
    double sum = 0.0;
    for (const BodyId body : bodies) sum += kinetic_energy(*box, manager.mass(body), manager.state(body)) + manager.mass(body) * kCaseGravity * manager.state(body).position.z();
    return sum;
  };
  PileRun run;
  const double first = energy();
  for (int i = 0; i < int(std::lround(seconds / dt)); ++i) {
    manager.step(dt);
    for (const BodyId body : bodies) run.top_speed = std::max(run.top_speed, manager.state(body).velocity.norm());
    run.energy_gain = std::max(run.energy_gain, energy() / first - 1.0);
  }
  run.lowest = manager.state(bodies[0]).position.z();
  for (const BodyId body : bodies) run.lowest = std::min(run.lowest, manager.state(body).position.z());
  return run;
}

void add_pile(std::vector<HardCaseRow>& rows, LevelChoice level, const std::string& name, double dt, double seconds) {
  const PileRun run = run_pile(level, dt, seconds);
  const std::string what = fmt::format("27 boxes fall into a {} pile, {:g} s, dt {:g} s: ", name, seconds, dt);
  rows.push_back({.what = what + "top speed", .value = run.top_speed, .bound = 1.05 * std::sqrt(2.0 * kCaseGravity * kTop), .unit = "m/s"});
  rows.push_back({.what = what + "energy gained", .value = run.energy_gain, .bound = 0.01});
  rows.push_back({.what = what + "lowest centre at the end", .value = run.lowest, .bound = 0.09, .unit = "m", .side = BoundSide::at_least});
}

}  // namespace

std::vector<HardCaseRow> measure_step_lengths(const HardCaseSettings& settings) {
  std::vector<HardCaseRow> rows{unclear_steps()};
  for (const auto& [level, name] : {std::pair{LevelChoice::full, "full"}, {LevelChoice::statistical, "statistical"}}) {
    add_pile(rows, level, name, 0.1, 6.0);
    add_pile(rows, level, name, 1e-5, settings.quick ? 0.01 : 0.6);
  }
  return rows;
}

}  // namespace lodestone
