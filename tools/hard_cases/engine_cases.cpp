// F15 to F17: what the whole engine does with places, steps and durations that ODE alone would not survive.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "reference/random.h"
#include "tools/hard_cases/case_parts.h"
#include "tools/hard_cases/hard_case.h"
#include "tools/hard_cases/scene_text.h"
#include "tools/memory.h"
#include "tools/step_argument.h"

namespace lodestone {
namespace {

// F15: scenes with coordinates beyond 1e8 m or infinite; bodies that fly there.
namespace far_coordinates {

std::string scene_with(const std::string& body, const std::string& more_ground = "",
                       const std::string& viewpoint = "[0, 0, 0]") {
  return fmt::format(
      "version: 1\nshapes: {{crate: {{box_m: [0.2, 0.3, 0.4]}}}}\nground: [{{plane: {{normal: [0, 0, 1], "
      "offset_m: 0}}}}{}]\n"
      "bodies:\n  - {}\nviewpoints: [{{position_m: {}}}]\n",
      more_ground, body, viewpoint);
}

HardCaseRow unclear_scenes() {
  const std::string sound = "{shape: crate, position_m: [0, 0, 1]}";
  int scenes = 0, unclear = !scene_error_of(scene_with(sound)).empty();
  for (const std::string far : {"2e8", "-1e9", "1e300", ".inf", "-.inf", ".nan"}) {
    const std::string place = "[0, " + far + ", 1]";
    const std::string positions[] = {
        scene_with("{shape: crate, position_m: " + place + "}"),
        scene_with(sound, ", {box: {sides_m: [1, 1, 1], position_m: " + place + "}}"),
        scene_with(sound, "", place)};
    const std::string scatter[] = {
        scene_with("{shape: crate, scatter: {count: 3, box_m: [[0, 0, 0], " + place + "], seed: 1}}")};
    const std::string plane[] = {scene_with(sound, ", {plane: {normal: [0, 0, 1], offset_m: " + far + "}}")};
    unclear += count_unclear(positions, "position_m") + count_unclear(scatter, "box_m") +
               count_unclear(plane, "offset_m");
    scenes += 5;
  }
  return {
      .what = fmt::format("{} scenes with a coordinate beyond 1e8 m or none: without a clear error", scenes),
      .value = double(unclear),
      .bound = 0.0,
      .unit = "scenes"};
}

/// Bodies that fly out of what the levels can hold, then change level there.
void add_flights(std::vector<HardCaseRow>& rows, LevelChoice level, const std::string& name) {
  constexpr int kBodies = 10, kFrames = 120;
  constexpr double kEdge = 1e8, kSpeed = 1e6;
  Manager manager = make_unmeasured_manager();
  std::vector<BodyId> bodies;
  for (int i = 0; i < kBodies; ++i) {
    RandomStream random(15, i, 0);
    const Vec3 outward = random.direction();
    const RigidState start{.position = outward * ((kEdge - kSpeed) / outward.lpNorm<Eigen::Infinity>()),
                           .velocity = kSpeed * outward,
                           .angular_velocity = random.direction()};
    bodies.push_back(manager.add_body({.shape = box_of({0.2, 0.3, 0.4}), .state = start, .level = level}));
  }
  for (int i = 0; i < kFrames; ++i) manager.step(1.0 / 60);
  for (const BodyId body : bodies)
    manager.set_level(body, level == LevelChoice::full ? LevelChoice::statistical : LevelChoice::full);
  for (int i = 0; i < kFrames; ++i) manager.step(1.0 / 60);
  int outside = 0;
  for (const BodyId body : bodies)
    outside += !(manager.state(body).position.lpNorm<Eigen::Infinity>() <= kEdge);
  const std::string what =
      fmt::format("{} {} bodies fly towards 1e8 m at 1e6 m/s and change level there: ", kBodies, name);
  rows.push_back(
      {.what = what + "outside at the end", .value = double(outside), .bound = 0.0, .unit = "bodies"});
  rows.push_back({.what = what + "recovered, counted",
                  .value = double(manager.report().counters.states_recovered),
                  .bound = 1.0,
                  .side = BoundSide::at_least});
}

std::vector<HardCaseRow> measure_case(const HardCaseSettings&) {
  std::vector<HardCaseRow> rows{unclear_scenes()};
  add_flights(rows, LevelChoice::full, "full");
  add_flights(rows, LevelChoice::statistical, "statistical");
  return rows;
}

}  // namespace far_coordinates

// F16: a sleeping pile, stepped ten million times: its state and the process's memory.
namespace sleeping_pile {

constexpr int kBodies = 20;
constexpr double kStep = 1.0 / 60, kMostSeconds = 60.0;

/// Boxes dropped on each other and stepped until all sleep.
Manager make_sleeping_pile(LevelChoice level) {
  Manager manager = make_unmeasured_manager();
  manager.add_plane(Vec3::UnitZ(), 0.0);
  const auto box = box_of({0.2, 0.3, 0.2});
  for (int i = 0; i < kBodies; ++i) {
    RandomStream random(16, i, 0);
    const double y = random.uniform(-0.05, 0.05), x = random.uniform(-0.05, 0.05);
    const Vec3 place(0.3 * (i % 2) + x, 0.35 * (i / 2 % 2) + y, 0.15 + 0.25 * (i / 4));
    manager.add_body({.shape = box, .state = {.position = place}, .level = level});
  }
  for (int i = 0; i * kStep < kMostSeconds && manager.report().asleep < kBodies; ++i) manager.step(kStep);
  return manager;
}

void add_rows(std::vector<HardCaseRow>& rows, LevelChoice level, const std::string& name,
              std::int64_t steps) {
  Manager manager = make_sleeping_pile(level);
  const std::string what = fmt::format("{:.0e} steps of a sleeping {} pile: ", double(steps), name);
  rows.push_back({.what = what + "awake at the start",
                  .value = double(kBodies - manager.report().asleep),
                  .bound = 0.0,
                  .unit = "bodies"});
  const std::uint64_t hash = manager.state_hash();
  const double before = resident_bytes();
  for (std::int64_t i = 0; i < steps; ++i) manager.step(kStep);
  rows.push_back(
      {.what = what + "state hash changed", .value = manager.state_hash() == hash ? 0.0 : 1.0, .bound = 0.0});
  rows.push_back(
      {.what = what + "growth of memory", .value = resident_bytes() - before, .bound = 1e6, .unit = "bytes"});
}

std::vector<HardCaseRow> measure_case(const HardCaseSettings& settings) {
  const std::int64_t steps = settings.quick ? 100'000 : 10'000'000;
  std::vector<HardCaseRow> rows;
  add_rows(rows, LevelChoice::full, "full", steps);
  add_rows(rows, LevelChoice::statistical, "statistical", steps);
  return rows;
}

}  // namespace sleeping_pile

// F17: steps of 1e-5 and 1/10 s, zero, negative and no number at all.
namespace step_lengths {

constexpr double kTop = 1.3;  // m, of the highest body

std::string scene_with(const std::string& dt) {
  return fmt::format(
      "version: 1\nstep: {{dt_s: {}}}\nshapes: {{crate: {{box_m: [0.2, 0.3, 0.4]}}}}\nground: [{{plane: "
      "{{normal: [0, 0, 1], offset_m: 0}}}}]\n"
      "bodies:\n  - {{shape: crate, position_m: [0, 0, 1]}}\n",
      dt);
}

HardCaseRow unclear_steps() {
  const std::string arguments[] = {"0", "-0.01", "-1/60", "nan", "inf", "-inf", "1e-400", "0.2", "1/0", ""};
  const std::string values[] = {"0", "-0.01", ".nan", ".inf", "-.inf", "0.2", "1", "a"};
  int unclear = 0;
  for (const std::string& text : arguments)
    unclear += find_step_fault(text).find("found '" + text + "', expected") == std::string::npos;
  std::vector<std::string> scenes;
  for (const std::string& value : values) scenes.push_back(scene_with(value));
  unclear += count_unclear(scenes, "step.dt_s");
  for (const std::string good : {"1e-5", "0.1"})
    unclear += !find_step_fault(good).empty() + !scene_error_of(scene_with(good)).empty();
  return {
      .what = "steps of 0, negative, over 1/10 s or no number, as --dt and in a scene: without a clear error",
      .value = double(unclear),
      .bound = 0.0,
      .unit = "steps"};
}

struct PileRun {
  double top_speed = 0.0, energy_gain = 0.0,
         lowest = 0.0;  ///< m/s; over that at the start; m, of any centre of mass at the end
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
    const double y = random.uniform(-0.01, 0.01), x = random.uniform(-0.01, 0.01);
    const Vec3 place(0.38 * (i % 3) + shift + x, 0.38 * (i / 3 % 3) + shift + y, kTop - 0.4 * (2 - i / 9));
    bodies.push_back(manager.add_body(
        {.shape = box, .state = {.position = place, .orientation = random.orientation()}, .level = level}));
  }
  const auto energy = [&] {
    double sum = 0.0;
    for (const BodyId body : bodies)
      sum += kinetic_energy(*box, manager.mass(body), manager.state(body)) +
             manager.mass(body) * kCaseGravity * manager.state(body).position.z();
    return sum;
  };
  PileRun run;
  const double first = energy();
  for (int i = 0; i < int(std::lround(seconds / dt)); ++i) {
    manager.step(dt);
    for (const BodyId body : bodies)
      run.top_speed = worse(run.top_speed, manager.state(body).velocity.norm());
    run.energy_gain = worse(run.energy_gain, energy() / first - 1.0);
  }
  run.lowest = manager.state(bodies[0]).position.z();
  for (const BodyId body : bodies) run.lowest = lesser(run.lowest, manager.state(body).position.z());
  return run;
}

void add_pile(std::vector<HardCaseRow>& rows, LevelChoice level, const std::string& name, double dt,
              double seconds) {
  const PileRun run = run_pile(level, dt, seconds);
  const std::string what =
      fmt::format("27 boxes fall into a {} pile, {:g} s, dt {:g} s: ", name, seconds, dt);
  rows.push_back({.what = what + "top speed",
                  .value = run.top_speed,
                  .bound = 1.05 * std::sqrt(2.0 * kCaseGravity * kTop),
                  .unit = "m/s"});
  rows.push_back({.what = what + "energy gained", .value = run.energy_gain, .bound = 0.01});
  rows.push_back({.what = what + "lowest centre at the end",
                  .value = run.lowest,
                  .bound = 0.09,
                  .unit = "m",
                  .side = BoundSide::at_least});
}

std::vector<HardCaseRow> measure_case(const HardCaseSettings& settings) {
  std::vector<HardCaseRow> rows{unclear_steps()};
  for (const auto& [level, name] :
       {std::pair{LevelChoice::full, "full"}, {LevelChoice::statistical, "statistical"}}) {
    add_pile(rows, level, name, 0.1, 6.0);
    add_pile(rows, level, name, 1e-5, settings.quick ? 0.01 : 0.6);
  }
  return rows;
}

}  // namespace step_lengths

}  // namespace

std::span<const HardCase> engine_cases() {
  static constexpr std::array kCases = {
      HardCase{"F15", far_coordinates::measure_case},
      HardCase{"F16", sleeping_pile::measure_case, true},
      HardCase{"F17", step_lengths::measure_case},
  };
  return kCases;
}

}  // namespace lodestone
