#include <fmt/format.h>

#include <algorithm>

#include "reference/random.h"
#include "tools/bench/case_parts.h"
#include "tools/bench/engine_cases.h"
#include "tools/bench/scene_text.h"

namespace lodestone {
namespace {

std::string scene_with(const std::string& body, const std::string& more_ground = "", const std::string& viewpoint = "[0, 0, 0]") {
  return fmt::format("version: 1\nshapes: {{crate: {{box_m: [0.2, 0.3, 0.4]}}}}\nground: [{{plane: {{normal: [0, 0, 1], offset_m: 0}}}}{}]\n"
                     "bodies:\n  - {}\nviewpoints: [{{position_m: {}}}]\n", more_ground, body, viewpoint);
}

HardCaseRow unclear_scenes() {
  const std::string sound = "{shape: crate, position_m: [0, 0, 1]}";
  int scenes = 0, unclear = !scene_error_of(scene_with(sound)).empty();
  for (const std::string far : {"2e8", "-1e9", "1e300", ".inf", "-.inf", ".nan"}) {
    const std::string place = "[0, " + far + ", 1]";
    const std::string positions[] = {scene_with("{shape: crate, position_m: " + place + "}"),
                                     scene_with(sound, ", {box: {sides_m: [1, 1, 1], position_m: " + place + "}}"), scene_with(sound, "", place)};
    const std::string scatter[] = {scene_with("{shape: crate, scatter: {count: 3, box_m: [[0, 0, 0], " + place + "], seed: 1}}")};
    const std::string plane[] = {scene_with(sound, ", {plane: {normal: [0, 0, 1], offset_m: " + far + "}}")};
    unclear += count_unclear(positions, "position_m") + count_unclear(scatter, "box_m") + count_unclear(plane, "offset_m");
    scenes += 5;
  }
  return {.what = fmt::format("{} scenes with a coordinate beyond 1e8 m or none: without a clear error", scenes), .value = double(unclear), .bound = 0.0, .unit = "scenes"};
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
    const RigidState start{.position = outward * ((kEdge - kSpeed) / outward.lpNorm<Eigen::Infinity>()), .velocity = kSpeed * outward, .angular_velocity = random.direction()};
    bodies.push_back(manager.add_body({.shape = box_of({0.2, 0.3, 0.4}), .state = start, .level = level}));
  }
  for (int i = 0; i < kFrames; ++i) manager.step(1.0 / 60);
  for (const BodyId body : bodies) manager.set_level(body, level == LevelChoice::full ? LevelChoice::statistical : LevelChoice::full);
  for (int i = 0; i < kFrames; ++i) manager.step(1.0 / 60);
  int outside = 0;
  for (const BodyId body : bodies) outside += !(manager.state(body).position.lpNorm<Eigen::Infinity>() <= kEdge);
  const std::string what = fmt::format("{} {} bodies fly towards 1e8 m at 1e6 m/s and change level there: ", kBodies, name);
  rows.push_back({.what = what + "outside at the end", .value = double(outside), .bound = 0.0, .unit = "bodies"});
  rows.push_back({.what = what + "recovered, counted", .value = double(manager.report().counters.states_recovered), .bound = 1.0, .side = BoundSide::at_least});
}

}  // namespace

std::vector<HardCaseRow> measure_far_coordinates(const HardCaseSettings&) {
  std::vector<HardCaseRow> rows{unclear_scenes()};
  add_flights(rows, LevelChoice::full, "full");
  add_flights(rows, LevelChoice::statistical, "statistical");
  return rows;
}

}  // namespace lodestone
