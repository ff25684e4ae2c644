#include "scenes/scene_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "scenes/scene_sections.h"
#include "scenes/yaml_cursor.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

SceneStep load_step(const YamlCursor& root, const SceneLoadSettings& settings, int& steps) {
  SceneStep step;
  if (auto section = root.find("step")) {
    section->expect_keys({"dt_s", "steps", "full_substeps", "gravity_m_per_s2", "seed"});
    if (auto key = section->find("dt_s")) step.dt_s = key->quotient({1e-9, 0.1});
    if (auto key = section->find("steps")) steps = int(key->integer(1, 100'000'000));
    if (auto key = section->find("full_substeps")) step.full_substeps = int(key->integer(1, 1000));
    if (auto key = section->find("gravity_m_per_s2")) step.gravity_m_per_s2 = key->vector({-1e4, 1e4});
    if (auto key = section->find("seed"))
      step.seed = std::uint64_t(key->integer(0, std::numeric_limits<std::int64_t>::max()));
  }
  step.seed = settings.seed.value_or(step.seed);
  return step;
}

SceneViewpoint load_viewpoint(const YamlCursor& place) {
  place.expect_keys({"position_m", "look_at_m", "path", "height_px"});
  SceneViewpoint viewpoint;
  if (auto key = place.find("look_at_m")) viewpoint.look_at_m = key->vector();
  if (auto key = place.find("height_px")) viewpoint.height_px = key->number({1, 1e5});
  if (auto key = place.find("path")) {
    for (const YamlCursor& corner : key->items()) {
      corner.expect_keys({"time_s", "position_m"});
      const double after = viewpoint.path.empty() ? 0.0 : viewpoint.path.back().time_s;
      viewpoint.path.push_back({corner.at("time_s").number({after, 1e6, !viewpoint.path.empty()}),
                                corner.at("position_m").vector()});
    }
    if (viewpoint.path.empty()) key->fail("an empty list", "a list of {time_s, position_m}");
    if (auto position = place.find("position_m")) position->fail("a position beside a path", "one of them");
    viewpoint.position_m = viewpoint.path.front().position_m;
  } else {
    viewpoint.position_m = place.at("position_m").vector();
  }
  return viewpoint;
}

std::vector<SceneViewpoint> load_viewpoints(const YamlCursor& root) {
  std::vector<SceneViewpoint> viewpoints;
  if (auto section = root.find("viewpoints"))
    for (const YamlCursor& place : section->items()) viewpoints.push_back(load_viewpoint(place));
  return viewpoints;
}

DistancePolicy load_distances(const YamlCursor& section) {
  DistancePolicy policy;
  if (auto key = section.find("full_within_m")) policy.full_within = key->number(kNotNegative);
  if (auto key = section.find("support_within_m")) {
    policy.support_within = key->number(kNotNegative);
    if (policy.support_within < policy.full_within)
      key->fail(key->found(), fmt::format("at least full_within_m ({:g})", policy.full_within));
  }
  return policy;
}

ProjectedSizePolicy load_sizes(const YamlCursor& section) {
  ProjectedSizePolicy policy;
  if (auto key = section.find("full_above_px")) policy.full_above_px = key->number(kNotNegative);
  if (auto key = section.find("support_above_px")) {
    policy.support_above_px = key->number(kNotNegative);
    if (policy.support_above_px > policy.full_above_px)
      key->fail(key->found(), fmt::format("at most full_above_px ({:g})", policy.full_above_px));
  }
  return policy;
}

/// Of time or of work; `by_error`: spent where it lessens the error most.
void load_budget(const YamlCursor& section, bool by_error, PolicySettings& lod) {
  constexpr NumberRange kTime{0, 1e6}, kWork{0, 1e9};
  if (section.one_key_of({"budget_ms", "budget_work"}) == "budget_ms") {
    const double ms = section.at("budget_ms").number(kTime);
    if (by_error)
      lod.policy = ErrorBudgetPolicy{.budget_ms = ms};
    else
      lod.policy = BudgetPolicy{ms};
  } else {
    const double work = section.at("budget_work").number(kWork);
    if (by_error)
      lod.policy = ErrorBudgetPolicy{.budget_work = work};
    else
      lod.policy = WorkPolicy{work};
  }
}

/// Each policy has keys of its own; one that belongs to another is refused, since it would do nothing.
void refuse_keys_of_others(const YamlCursor& section, const std::string& policy) {
  struct Keys {
    std::vector<std::string> policies, keys;
    std::string expected;
  };
  static const std::vector<Keys> kKeys{
      {{"distance"}, {"full_within_m", "support_within_m"}, "full_within_m and support_within_m"},
      {{"projected_size"}, {"full_above_px", "support_above_px"}, "full_above_px and support_above_px"},
      {{"budget", "error_budget"}, {"budget_ms", "budget_work"}, "budget_ms or budget_work"}};
  const auto own =
      std::ranges::find_if(kKeys, [&](const Keys& k) { return std::ranges::count(k.policies, policy) > 0; });
  for (const Keys& others : kKeys)
    for (const std::string& key : others.keys)
      if (auto found = section.find(key); found && &others != &*own)
        found->fail(fmt::format("{} with policy {}", key, policy), own->expected);
}

void load_policy(const YamlCursor& section, PolicySettings& lod) {
  static const std::array<std::string, 4> kPolicies{"distance", "budget", "projected_size", "error_budget"};
  const auto key = section.find("policy");
  const std::string& policy = kPolicies[key ? key->choice(kPolicies) : 0];
  refuse_keys_of_others(section, policy);
  if (policy == "distance")
    lod.policy = load_distances(section);
  else if (policy == "projected_size")
    lod.policy = load_sizes(section);
  else
    load_budget(section, policy == "error_budget", lod);
}

/// What every policy has.
void load_limits(const YamlCursor& section, PolicySettings& lod) {
  constexpr std::int64_t kMost = kUnlimited;
  if (auto key = section.find("most_full")) lod.most_full = int(key->integer(0, kMost));
  if (auto key = section.find("most_support")) lod.most_support = int(key->integer(0, kMost));
  if (auto key = section.find("hysteresis")) lod.hysteresis = key->number({0, 10});
  if (auto key = section.find("min_dwell_frames")) lod.min_dwell_frames = int(key->integer(0, 1'000'000));
  if (auto key = section.find("max_transitions_per_frame"))
    lod.max_transitions_per_frame = int(key->integer(1, 1'000'000));
  if (auto key = section.find("out_of_view_factor")) lod.out_of_view_factor = key->number({1, 1e9});
  if (auto key = section.find("look_ahead_s")) lod.look_ahead_s = key->number({0, 10});
  if (auto key = section.find("contact_groups_together")) lod.contact_groups_together = key->truth();
}

TablesOptions load_tables_options(const YamlCursor& section) {
  TablesOptions options;
  section.expect_keys({"published", "interpolate", "draw_height", "radius_update_interval", "rest_poses",
                       "nearest_rest_pose", "paper_pair_rule"});
  if (auto key = section.find("published")) options.published = key->truth();
  if (auto key = section.find("interpolate")) options.interpolate = key->truth();
  if (auto key = section.find("draw_height")) options.draw_height = key->truth();
  if (auto key = section.find("radius_update_interval"))
    options.radius_update_interval = int(key->integer(1, 1000));
  if (auto key = section.find("rest_poses")) options.rest_poses = key->truth();
  if (auto key = section.find("nearest_rest_pose")) options.nearest_rest_pose = key->truth();
  if (auto key = section.find("paper_pair_rule")) options.paper_pair_rule = key->truth();
  return options;
}

std::optional<StatisticalModel> load_model(const YamlCursor& key) {
  static const std::array<std::string, 3> kModels{"auto", "support", "tables"};
  return std::array<std::optional<StatisticalModel>, 3>{std::nullopt, StatisticalModel::support,
                                                        StatisticalModel::tables}[key.choice(kModels)];
}

void load_lod(const YamlCursor& root, Scene& scene) {
  const auto section = root.find("lod");
  if (!section) return;
  section->expect_keys({"policy", "full_within_m", "support_within_m", "full_above_px", "support_above_px",
                        "budget_ms", "budget_work", "most_full", "most_support", "hysteresis",
                        "min_dwell_frames", "max_transitions_per_frame", "out_of_view_factor", "look_ahead_s",
                        "contact_groups_together", "audit_ms", "model", "tables"});
  load_policy(*section, scene.lod);
  load_limits(*section, scene.lod);
  if (auto key = section->find("audit_ms")) scene.audit_ms = key->number({0, 1e6});
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
    if (file.has_parent_path() || file.extension() != ".glb")
      key->fail(output.trajectory, "a file name that ends in .glb, without folders");
  }
  if (auto key = section->find("every_n_steps")) output.every_n_steps = int(key->integer(1, 1'000'000));
  return output;
}

SceneChecks load_checks(const YamlCursor& root, const std::vector<SceneGround>& ground) {
  SceneChecks checks;
  const auto section = root.find("check");
  if (!section) return checks;
  section->expect_keys({"max_penetration_m", "max_tables_penetration_m", "all_asleep_by_s"});
  const bool is_measured = std::ranges::any_of(
      ground, [](const SceneGround& part) { return !std::holds_alternative<GroundMesh>(part); });
  const auto depth = [&](const char* name) -> std::optional<double> {
    const auto key = section->find(name);
    if (!key) return {};
    const double bound = key->number(kNotNegative);
    if (!is_measured)
      key->fail("no ground but terrain and meshes", "a plane, a box or stairs, in which depths are measured");
    return bound;
  };
  checks.max_penetration_m = depth("max_penetration_m");
  checks.max_tables_penetration_m = depth("max_tables_penetration_m");
  if (auto key = section->find("all_asleep_by_s")) checks.all_asleep_by_s = key->number(kPositive);
  return checks;
}

ShapeOptions search_of(const fs::path& file, const SceneLoadSettings& settings) {
  ShapeOptions options{.stay_in_search = true, .untrusted = settings.untrusted};
  options.search.push_back(file.has_parent_path() ? file.parent_path() : fs::path("."));
  options.search.insert(options.search.end(), settings.mesh_paths.begin(), settings.mesh_paths.end());
  return options;
}

std::vector<fs::path> mesh_files_of(const Scene& scene, const std::map<std::string, SceneShape>& shapes) {
  std::vector<fs::path> files;
  for (const auto& [name, shape] : shapes)
    if (!shape.file.empty()) files.push_back(shape.file);
  for (const SceneGround& ground : scene.ground)
    if (const auto* mesh = std::get_if<GroundMesh>(&ground); mesh && !mesh->file.empty())
      files.push_back(mesh->file);
  return files;
}

}  // namespace

Scene load_scene(const fs::path& file, const SceneLoadSettings& settings) {
  const YamlValue document = load_yaml(file);
  const std::string name = file.string();
  const YamlCursor root(document, name);
  root.expect_keys({"version", "step", "materials", "contacts", "shapes", "ground", "bodies", "ragdolls",
                    "joints", "viewpoints", "lod", "output", "check"});
  root.at("version").integer(1, 1);
  const ShapeOptions search = search_of(file, settings);

  Scene scene;
  scene.file = file;
  scene.step = load_step(root, settings, scene.default_steps);
  // The quick sections first, so that their errors do not wait for meshes to load.
  scene.viewpoints = load_viewpoints(root);
  load_lod(root, scene);
  scene.output = load_output(root);
  load_materials(root, scene);
  scene.ground = load_ground(root, scene, search);
  scene.checks = load_checks(root, scene.ground);
  const std::map<std::string, SceneShape> shapes = load_shapes(root, scene, search);
  for (const auto& [shape_name, shape] : shapes) scene.shapes.emplace(shape_name, shape.shape);
  scene.mesh_files = mesh_files_of(scene, shapes);
  load_ragdolls(root, scene);
  add_bodies(root, scene, shapes, settings);
  load_joints(root, scene);
  return scene;
}

}  // namespace lodestone
