#include "scenes/scene_file.h"

#include <fmt/format.h>

#include <array>
#include <limits>

#include "scenes/body_section.h"
#include "scenes/material_section.h"
#include "scenes/shape_section.h"
#include "scenes/yaml_cursor.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

SceneStep load_step(const YamlCursor& root, const SceneLoadSettings& settings, int& steps) {
  SceneStep step;
  if (auto section = root.find("step")) {
    section->expect_keys({"dt_s", "steps", "full_substeps", "gravity_m_per_s2", "seed"});
    if (auto key = section->find("dt_s")) step.dt_s = key->number({0, 0.1, true});
    if (auto key = section->find("steps")) steps = int(key->integer(1, 100'000'000));
    if (auto key = section->find("full_substeps")) step.full_substeps = int(key->integer(1, 1000));
    if (auto key = section->find("gravity_m_per_s2")) step.gravity_m_per_s2 = key->vector({-1e4, 1e4});
    if (auto key = section->find("seed")) step.seed = std::uint64_t(key->integer(0, std::numeric_limits<std::int64_t>::max()));
  }
  step.seed = settings.seed.value_or(step.seed);
  return step;
}

Viewpoint load_viewpoint(const YamlCursor& place) {
  place.expect_keys({"position_m", "look_at_m", "path"});
  Viewpoint viewpoint;
  if (auto key = place.find("look_at_m")) viewpoint.look_at_m = key->vector();
  if (auto key = place.find("path")) {
    for (const YamlCursor& corner : key->items()) {
      corner.expect_keys({"time_s", "position_m"});
      const double after = viewpoint.path.empty() ? 0.0 : viewpoint.path.back().time_s;
      viewpoint.path.push_back({corner.at("time_s").number({after, 1e6, !viewpoint.path.empty()}), corner.at("position_m").vector()});
    }
    if (viewpoint.path.empty()) key->fail("an empty list", "a list of {time_s, position_m}");
    viewpoint.position_m = viewpoint.path.front().position_m;
  }
  if (auto key = place.find("position_m")) viewpoint.position_m = key->vector();
  else if (viewpoint.path.empty()) place.at("position_m");
  return viewpoint;
}

std::vector<Viewpoint> load_viewpoints(const YamlCursor& root) {
  std::vector<Viewpoint> viewpoints;
  if (auto section = root.find("viewpoints"))
    for (const YamlCursor& place : section->items()) viewpoints.push_back(load_viewpoint(place));
  return viewpoints;
}

DistancePolicy load_distances(const YamlCursor& section) {
  DistancePolicy policy;
  for (const char* key : {"budget_ms", "budget_work"})
    if (auto budget = section.find(key)) budget->fail(fmt::format("{} with policy distance", key), "full_within_m and support_within_m");
  if (auto key = section.find("full_within_m")) policy.full_within = key->number(kNotNegative);
  if (auto key = section.find("support_within_m")) {
    policy.support_within = key->number(kNotNegative);
    if (policy.support_within < policy.full_within) key->fail(key->found(), fmt::format("at least full_within_m ({:g})", policy.full_within));
  }
  return policy;
}

/// Of time or of work.
void load_budget(const YamlCursor& section, PolicySettings& lod) {
  constexpr NumberRange kTime{0, 1e6}, kWork{0, 1e9};
  for (const char* key : {"full_within_m", "support_within_m"})
    if (auto within = section.find(key)) within->fail(fmt::format("{} with policy budget", key), "budget_ms or budget_work");
  if (section.one_key_of({"budget_ms", "budget_work"}) == "budget_ms") lod.policy = BudgetPolicy{section.at("budget_ms").number(kTime)};
  else lod.policy = WorkPolicy{section.at("budget_work").number(kWork)};
}

/// A key that belongs to the other policy is refused, since it would do nothing.
void load_policy(const YamlCursor& section, PolicySettings& lod) {
  static const std::array<std::string, 2> kPolicies{"distance", "budget"};
  const auto policy = section.find("policy");
  if (policy && policy->choice(kPolicies) == 1) load_budget(section, lod);
  else lod.policy = load_distances(section);
  constexpr std::int64_t kMost = kUnlimited;
  if (auto key = section.find("most_full")) lod.most_full = int(key->integer(0, kMost));
  if (auto key = section.find("most_support")) lod.most_support = int(key->integer(0, kMost));
  if (auto key = section.find("hysteresis")) lod.hysteresis = key->number({0, 10});
  if (auto key = section.find("min_dwell_frames")) lod.min_dwell_frames = int(key->integer(0, 1'000'000));
  if (auto key = section.find("max_transitions_per_frame")) lod.max_transitions_per_frame = int(key->integer(1, 1'000'000));
}

bool truth_of(const YamlCursor& key) {
  static const std::array<std::string, 2> kTruths{"false", "true"};
  return key.choice(kTruths) == 1;
}

TablesOptions load_tables_options(const YamlCursor& section) {
  TablesOptions options;
  section.expect_keys({"interpolate", "draw_height", "radius_update_interval", "nearest_rest_pose", "paper_pair_rule"});
  if (auto key = section.find("interpolate")) options.interpolate = truth_of(*key);
  if (auto key = section.find("draw_height")) options.draw_height = truth_of(*key);
  if (auto key = section.find("radius_update_interval")) options.radius_update_interval = int(key->integer(1, 1000));
  if (auto key = section.find("nearest_rest_pose")) options.nearest_rest_pose = truth_of(*key);
  if (auto key = section.find("paper_pair_rule")) options.paper_pair_rule = truth_of(*key);
  return options;
}

std::optional<StatisticalModel> load_model(const YamlCursor& key) {
  static const std::array<std::string, 3> kModels{"auto", "support", "tables"};
  return std::array<std::optional<StatisticalModel>, 3>{std::nullopt, StatisticalModel::support, StatisticalModel::tables}[key.choice(kModels)];
}

void load_lod(const YamlCursor& root, Scene& scene) {
  const auto section = root.find("lod");
  if (!section) return;
  section->expect_keys({"policy", "full_within_m", "support_within_m", "budget_ms", "budget_work", "most_full", "most_support", "hysteresis", "min_dwell_frames",
                        "max_transitions_per_frame", "model", "tables"});
  load_policy(*section, scene.lod);
  if (auto key = section->find("model")) scene.model = load_model(*key);
  if (auto tables = section->find("tables")) scene.tables = load_tables_options(*tables);
}

SceneOutput load_output(const YamlCursor& root) {
  SceneOutput output;
  const auto section = root.find("output");
  if (!section) return output;
  section->expect_keys({"trajectory", "every_n_steps"});
  if (auto key = section->find("trajectory")) {
    output.trajectory = key->text();
    const fs::path file = output.trajectory;
    if (file.has_parent_path() || file.extension() != ".glb") key->fail(output.trajectory, "a file name that ends in .glb, without folders");
  }
  if (auto key = section->find("every_n_steps")) output.every_n_steps = int(key->integer(1, 1'000'000));
  return output;
}

SceneChecks load_checks(const YamlCursor& root) {
  SceneChecks checks;
  const auto section = root.find("check");
  if (!section) return checks;
  section->expect_keys({"max_penetration_m", "max_tables_penetration_m", "all_asleep_by_s"});
  if (auto key = section->find("max_penetration_m")) checks.max_penetration_m = key->number(kNotNegative);
  if (auto key = section->find("max_tables_penetration_m")) checks.max_tables_penetration_m = key->number(kNotNegative);
  if (auto key = section->find("all_asleep_by_s")) checks.all_asleep_by_s = key->number(kPositive);
  return checks;
}

ShapeOptions search_of(const fs::path& file, const SceneLoadSettings& settings) {
  ShapeOptions options{.stay_in_search = true};
  options.search.push_back(file.has_parent_path() ? file.parent_path() : fs::path("."));
  options.search.insert(options.search.end(), settings.mesh_paths.begin(), settings.mesh_paths.end());
  return options;
}

}  // namespace

Scene load_scene(const fs::path& file, const SceneLoadSettings& settings) {
  const YamlValue document = load_yaml(file);
  const std::string name = file.string();
  const YamlCursor root(document, name);
  root.expect_keys({"version", "step", "materials", "contacts", "shapes", "ground", "bodies", "viewpoints", "lod", "output", "check"});
  root.at("version").integer(1, 1);
  const ShapeOptions search = search_of(file, settings);

  Scene scene;
  scene.file = file;
  scene.step = load_step(root, settings, scene.default_steps);
  // The quick sections first, so that their errors do not wait for meshes to load.
  scene.viewpoints = load_viewpoints(root);
  load_lod(root, scene);
  scene.output = load_output(root);
  scene.checks = load_checks(root);
  load_materials(root, scene);
  scene.ground = load_ground(root, scene, search);
  const std::map<std::string, SceneShape> shapes = load_shapes(root, scene, search);
  scene.bodies = load_bodies(root, scene, shapes, settings);
  for (const auto& [shape_name, shape] : shapes) scene.shapes.emplace(shape_name, shape.shape);
  return scene;
}

}  // namespace lodestone
