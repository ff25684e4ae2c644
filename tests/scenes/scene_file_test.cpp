#include "scenes/scene_file.h"

#include <algorithm>
#include <cmath>

#include "tests/scenes/scene_fixture.h"

namespace lodestone::scene_file_test {
namespace {

using SceneFile = SceneFixture;

// The format's example with every key of it, the meshes replaced by one that the test brings.
const char* const kEveryKey = R"(version: 1
step: {dt_s: 1/100, full_substeps: 3, gravity_m_per_s2: [0, 1, -5], seed: 7, steps: 12}
materials:
  wood: {density_kg_per_m3: 500}
  default: {restitution: 0.4, friction: 0.5, density_kg_per_m3: 1000}
  ice: {friction: 0.02}
contacts: [{between: [wood, ice], restitution: 0.6, friction: 0.1}]
shapes:
  rock: {mesh: rock.obj, size_m: 0.2, mass_kg: 2, obtain: from the test}
  crate: {box_m: [0.2, 0.3, 0.4], material: wood}
  heavy: {box_m: [1, 1, 1], mass_kg: 6, inertia: [1, 2, 2.5], center_of_mass_m: [0, 0, -0.1]}
  tensor: {box_m: [1, 1, 1], mass_kg: 1, inertia: [[1, 0.1, 0], [0.1, 1, 0], [0, 0, 1]]}
  ball: {sphere_m: 0.1}
  bar: {l_m: [0.3, 0.2, 0.05, 0.04]}
  tile: {plate_m: [0.3, 0.3, 0.01]}
  pin: {needle_m: [0.5, 0.01]}
ground:
  - {plane: {normal: [0, 0, 2], offset_m: -1}, material: ice}
  - {box: {sides_m: [1, 2, 3], position_m: [50, 0, 0], orientation: [2, 0, 0, 0]}}
  - {mesh: rock.obj, size_m: 5, position_m: [100, 0, 0]}
bodies:
  - {shape: crate, position_m: [0, 0, 2], orientation: [2, 0, 0, 0], velocity_m_per_s: [1, 0, 0], level: full, name: hero}
  - {shape: ball, position_m: [3, 0, 2], angular_velocity_rad_per_s: [0, 0, 9], level: statistical, importance: 2, material: ice, mass_kg: 9}
  - {shape: rock, name: r, scatter: {count: 20, box_m: [[-5, -5, 1], [5, 5, 4]], seed: 3, spacing_m: 0.5}}
  - {shape: pin, scatter: {count: 5, cylinder: {base_m: [20, 0, 1], radius_m: 1, height_m: 3}}}
viewpoints: [{look_at_m: [0, 0, 1], path: [{time_s: 0, position_m: [0, -6, 2]}, {time_s: 2, position_m: [0, 6, 2]}]}]
lod: {policy: budget, budget_ms: 3, most_full: 5, most_support: 0, hysteresis: 0.2, min_dwell_frames: 10, max_transitions_per_frame: 2, model: tables, tables: {published: false}}
output: {trajectory: run.glb, every_n_steps: 3}
check: {max_penetration_m: 0.02, max_tables_penetration_m: 0.2, all_asleep_by_s: 10}
)";

TEST_F(SceneFile, EveryKeyArrives) {
  write(tetrahedron_obj(), "rock.obj");
  const Scene scene = load(kEveryKey);
  EXPECT_EQ(scene.step.dt_s, 0.01);
  EXPECT_EQ(scene.step.full_substeps, 3);
  EXPECT_EQ(scene.step.gravity_m_per_s2, Vec3(0, 1, -5));
  EXPECT_EQ(scene.step.seed, 7u);
  EXPECT_EQ(scene.default_steps, 12);
  ASSERT_EQ(scene.material_names, (std::vector<std::string>{"default", "wood", "ice"}));
  EXPECT_EQ(scene.materials[1].density, 500);
  EXPECT_EQ(scene.materials[1].restitution, 0.4);
  EXPECT_EQ(scene.materials.law(1, 2), (ContactLaw{0.6, 0.1}));
  EXPECT_EQ(scene.shapes.size(), 8u);
  EXPECT_NEAR(scene.shapes.at("rock")->size, 0.2, 1e-9);
  EXPECT_EQ(scene.shapes.at("ball")->sphere_radius, 0.1);
  EXPECT_NEAR(scene.shapes.at("heavy")->inertia_per_mass(2, 2), 2.5 / 6, 1e-12);
  EXPECT_NEAR(scene.shapes.at("heavy")->center_of_mass_in_mesh.z(), -0.1, 1e-12);
  EXPECT_NEAR(scene.shapes.at("tensor")->inertia_per_mass(0, 1), 0.1, 1e-12);
  EXPECT_EQ(scene.model, StatisticalModel::tables);
  EXPECT_FALSE(scene.tables.published);
  EXPECT_EQ(std::get<BudgetPolicy>(scene.lod.policy).budget_ms, 3);
  EXPECT_EQ(scene.lod.most_full, 5);
  EXPECT_EQ(scene.lod.most_support, 0);
  EXPECT_EQ(scene.lod.hysteresis, 0.2);
  EXPECT_EQ(scene.lod.min_dwell_frames, 10);
  EXPECT_EQ(scene.lod.max_transitions_per_frame, 2);
  EXPECT_EQ(scene.output.trajectory, "run.glb");
  EXPECT_EQ(scene.output.every_n_steps, 3);
  EXPECT_EQ(scene.checks.max_penetration_m, 0.02);
  EXPECT_EQ(scene.checks.max_tables_penetration_m, 0.2);
  EXPECT_EQ(scene.checks.all_asleep_by_s, 10);
}

TEST_F(SceneFile, GroundAndViewpointsArrive) {
  write(tetrahedron_obj(), "rock.obj");
  const Scene scene = load(kEveryKey);
  ASSERT_EQ(scene.ground.size(), 3u);
  EXPECT_EQ(std::get<GroundPlane>(scene.ground[0]).normal, Vec3(0, 0, 1));
  EXPECT_EQ(std::get<GroundPlane>(scene.ground[0]).offset_m, -1);
  EXPECT_EQ(std::get<GroundPlane>(scene.ground[0]).material, 2);
  EXPECT_EQ(std::get<GroundBox>(scene.ground[1]).orientation.w(), 1);
  Eigen::AlignedBox3d box;
  for (const Vec3& vertex : std::get<GroundMesh>(scene.ground[2]).mesh.vertices) box.extend(vertex);
  EXPECT_TRUE(box.min().isApprox(Vec3(100, 0, 0)) && box.max().isApprox(Vec3(105, 5, 5)));
  ASSERT_EQ(scene.viewpoints.size(), 1u);
  EXPECT_EQ(scene.viewpoints[0].position_at(1.0), Vec3(0, 0, 2));
}

TEST_F(SceneFile, TerrainAndStairsArrive) {
  const Scene scene = load(R"(version: 1
materials: {ice: {friction: 0}}
shapes: {ball: {sphere_m: 0.1}}
ground:
  - {terrain: {cells: [1, 2], size_m: [4, 8], position_m: [0, 0, 1], heights_m: [[0, 0], [1, 1], [0, 0]]}, material: ice}
  - {terrain: {cells: [1, 1], size_m: [2, 2], position_m: [50, 0, 0], hills: [{height_m: 3, length_m: [1, 1]}]}}
  - {stairs: {steps: 4, rise_m: 0.2, run_m: 0.3, width_m: 1, position_m: [10, 0, 0], turn_deg: 90}, material: ice}
bodies:
  - {shape: ball, scatter: {count: 40, on_ground: true, box_m: [[-1.9, -3.9, 0], [1.9, 3.9, 0]]}}
)");
  ASSERT_EQ(scene.ground.size(), 6u);
  EXPECT_EQ(std::get<GroundMesh>(scene.ground[0]).mesh.vertices[2], Vec3(-2, 0, 2));
  EXPECT_EQ(std::get<GroundMesh>(scene.ground[0]).material, 1);
  EXPECT_EQ(std::get<GroundMesh>(scene.ground[1]).mesh.vertices[0], Vec3(49, -1, 3));
  EXPECT_NEAR(std::get<GroundBox>(scene.ground[5]).sides_m.z(), 0.8, 1e-12);
  EXPECT_EQ(std::get<GroundBox>(scene.ground[5]).material, 1);
  for (const SceneBody& body : scene.bodies) {
    const Vec3& p = body.definition.state.position;
    const double ground_z = 2 - std::abs(p.y()) / 4;
    EXPECT_GE(p.z() - 0.1, ground_z - 1e-12);
    EXPECT_LE(p.z() - 0.1, ground_z + 0.1 / 4 + 1e-12)
        << "no higher than the roof's slope makes of its radius";
  }
}

TEST_F(SceneFile, BodiesArriveInOrder) {
  write(tetrahedron_obj(), "rock.obj");
  const Scene scene = load(kEveryKey);
  ASSERT_EQ(scene.bodies.size(), 27u);
  const BodyDefinition& hero = scene.bodies[0].definition;
  EXPECT_EQ(scene.bodies[0].name, "hero");
  EXPECT_EQ(hero.state.orientation.w(), 1);
  EXPECT_EQ(hero.state.velocity, Vec3(1, 0, 0));
  EXPECT_EQ(hero.level, LevelChoice::full);
  EXPECT_EQ(hero.material, 1);
  EXPECT_FALSE(hero.mass);
  const BodyDefinition& ball = scene.bodies[1].definition;
  EXPECT_EQ(ball.state.angular_velocity, Vec3(0, 0, 9));
  EXPECT_EQ(ball.level, LevelChoice::statistical);
  EXPECT_EQ(ball.importance, 2);
  EXPECT_EQ(ball.mass, 9);
  EXPECT_EQ(scene.bodies[2].name, "r[0]");
  EXPECT_EQ(scene.bodies[2].definition.mass, 2);
  for (int i = 22; i < 27; ++i)
    EXPECT_LE((scene.bodies[i].definition.state.position - Vec3(20, 0, 0)).head<2>().norm(), 1.0);
}

TEST_F(SceneFile, SeedOfTheRunReachesScatters) {
  write(tetrahedron_obj(), "rock.obj");
  const auto place = [&](std::optional<std::uint64_t> seed) {
    return load(kEveryKey, {.mesh_paths = {}, .seed = seed}).bodies[5].definition.state.position;
  };
  EXPECT_EQ(place(std::nullopt), place(std::nullopt));
  EXPECT_EQ(place(11), place(11));
  EXPECT_NE(place(std::nullopt), place(11));
}

TEST_F(SceneFile, PoliciesArrive) {
  const auto lod_of = [&](const std::string& keys) {
    return load("version: 1\nbodies: []\nlod: {" + keys + "}\n");
  };
  const auto plain = std::get<DistancePolicy>(lod_of("").lod.policy);
  EXPECT_EQ(plain.full_within, DistancePolicy().full_within);
  EXPECT_TRUE(std::isinf(plain.support_within));
  EXPECT_EQ(lod_of("").model, std::nullopt);
  EXPECT_EQ(lod_of("").lod.most_full, kUnlimited);
  const auto far =
      std::get<DistancePolicy>(lod_of("policy: distance, full_within_m: 2, support_within_m: 7").lod.policy);
  EXPECT_EQ(far.full_within, 2);
  EXPECT_EQ(far.support_within, 7);
  EXPECT_EQ(
      std::get<DistancePolicy>(lod_of("full_within_m: 2, support_within_m: 2").lod.policy).support_within, 2);
  EXPECT_EQ(std::get<WorkPolicy>(lod_of("policy: budget, budget_work: 2000").lod.policy).budget_work, 2000);
  const auto size = std::get<ProjectedSizePolicy>(
      lod_of("policy: projected_size, full_above_px: 80, support_above_px: 9").lod.policy);
  EXPECT_EQ(size.full_above_px, 80);
  EXPECT_EQ(size.support_above_px, 9);
  const auto error = std::get<ErrorBudgetPolicy>(lod_of("policy: error_budget, budget_ms: 6").lod.policy);
  EXPECT_EQ(error.budget_ms, 6);
  EXPECT_FALSE(error.budget_work);
  EXPECT_EQ(
      std::get<ErrorBudgetPolicy>(lod_of("policy: error_budget, budget_work: 900").lod.policy).budget_work,
      900);
  const Scene all =
      lod_of("out_of_view_factor: 4, look_ahead_s: 0.5, contact_groups_together: true, audit_ms: 0.3");
  EXPECT_EQ(all.lod.out_of_view_factor, 4);
  EXPECT_EQ(all.lod.look_ahead_s, 0.5);
  EXPECT_TRUE(all.lod.contact_groups_together);
  EXPECT_EQ(all.audit_ms, 0.3);
  EXPECT_EQ(lod_of("model: auto").model, std::nullopt);
  EXPECT_EQ(lod_of("model: support").model, StatisticalModel::support);
}

TEST_F(SceneFile, EveryLevelArrives) {
  const Scene scene = load(R"(version: 1
shapes: {ball: {sphere_m: 0.1}}
bodies:
  - {shape: ball, position_m: [0, 0, 1]}
  - {shape: ball, position_m: [1, 0, 1], level: auto}
  - {shape: ball, position_m: [2, 0, 1], level: full}
  - {shape: ball, position_m: [3, 0, 1], level: statistical}
  - {shape: ball, position_m: [4, 0, 1], level: support}
  - {shape: ball, position_m: [5, 0, 1], level: tables}
)");
  const LevelChoice expected[] = {LevelChoice::automatic,   LevelChoice::automatic, LevelChoice::full,
                                  LevelChoice::statistical, LevelChoice::support,   LevelChoice::tables};
  ASSERT_EQ(scene.bodies.size(), std::size(expected));
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    EXPECT_EQ(scene.bodies[i].definition.level, expected[i]) << i;
}

// --- errors: where, which key, what was found, what was expected

struct BadScene {
  const char* text;     // replaces or follows the valid parts
  const char* message;  // how the message must start
};

/// A valid scene around one line that is wrong.
std::string scene_with(const std::string& line, const std::string& shapes = "crate: {box_m: [1, 1, 1]}",
                       const std::string& body = "{shape: crate, position_m: [0, 0, 2]}") {
  return "version: 1\nshapes: {" + shapes + "}\nbodies: [" + body + "]\n" + line + "\n";
}

TEST_F(SceneFile, TopLevelErrors) {
  const BadScene cases[] = {
      {"stp: {}", "s.yaml:4: stp: found an unknown key, expected one of version, step,"},
      {"step: {dt: 0.1}", "s.yaml:4: step.dt: found an unknown key, expected one of dt_s, steps,"},
      {"step: {dt_s: 0}", "s.yaml:4: step.dt_s: found 0, expected a number in [1e-09, 0.1]"},
      {"step: {dt_s: -1}", "s.yaml:4: step.dt_s: found -1, expected"},
      {"step: {dt_s: 1/5}", "s.yaml:4: step.dt_s: found 1/5, expected a number in [1e-09, 0.1], or"},
      {"step: {dt_s: 1/0}", "s.yaml:4: step.dt_s: found 1/0, expected"},
      {"step: {dt_s: 1/60s}", "s.yaml:4: step.dt_s: found 1/60s, expected"},
      {"step: {dt_s: .nan}", "s.yaml:4: step.dt_s: found .nan, expected"},
      {"step: {dt_s: nan}", "s.yaml:4: step.dt_s: found nan, expected"},
      {"step: {dt_s: .inf}", "s.yaml:4: step.dt_s: found .inf, expected"},
      {"step: {dt_s: 1e999}", "s.yaml:4: step.dt_s: found 1e999, expected"},
      {"step: {dt_s: fast}", "s.yaml:4: step.dt_s: found fast, expected a number"},
      {"step: {dt_s: \"0.1\"}", "s.yaml:4: step.dt_s: found the text \"0.1\", expected a number"},
      {"step: {dt_s: [1]}", "s.yaml:4: step.dt_s: found a list of 1, expected a number"},
      {"step: {dt_s: }", "s.yaml:4: step.dt_s: found nothing, expected a number"},
      {"step: {steps: 010}", "s.yaml:4: step.steps: found 010, expected a whole number"},
      {"step: {steps: 2.5}", "s.yaml:4: step.steps: found 2.5, expected a whole number"},
      {"step: {full_substeps: 0}", "s.yaml:4: step.full_substeps: found 0, expected a whole number from 1"},
      {"step: {gravity_m_per_s2: [0, 0]}",
       "s.yaml:4: step.gravity_m_per_s2: found a list of 2, expected a list of 3"},
      {"step: {gravity_m_per_s2: [0, 0, x]}",
       "s.yaml:4: step.gravity_m_per_s2[2]: found x, expected a number"},
      {"step: 3", "s.yaml:4: step: found 3, expected a map"},
      {"step: {seed: -1}", "s.yaml:4: step.seed: found -1, expected"},
      {"version: 1", "s.yaml:4: version: found the key a second time"},
      {"lod: {policy: budgte}",
       "s.yaml:4: lod.policy: found budgte, expected one of distance, budget, projected_size, error_budget "
       "(did you mean \"budget\"?)"},
      {"lod: {policy: budget, full_within_m: 3}",
       "s.yaml:4: lod.full_within_m: found full_within_m with policy budget, expected budget_ms or "
       "budget_work"},
      {"lod: {policy: budget, support_within_m: 3}",
       "s.yaml:4: lod.support_within_m: found support_within_m with policy budget, expected budget_ms or "
       "budget_work"},
      {"lod: {policy: budget}", "s.yaml:4: lod: found none, expected one of budget_ms, budget_work"},
      {"lod: {policy: budget, budget_ms: 3, budget_work: 2000}",
       "s.yaml:4: lod: found budget_ms and budget_work, expected only one of"},
      {"lod: {policy: budget, budget_ms: -1}", "s.yaml:4: lod.budget_ms: found -1, expected a number in [0,"},
      {"lod: {policy: budget, budget_work: .inf}",
       "s.yaml:4: lod.budget_work: found .inf, expected a number in [0,"},
      {"lod: {budget_ms: 3}",
       "s.yaml:4: lod.budget_ms: found budget_ms with policy distance, expected full_within_m and "
       "support_within_m"},
      {"lod: {policy: projected_size, full_within_m: 3}",
       "s.yaml:4: lod.full_within_m: found full_within_m with policy projected_size, expected full_above_px "
       "and support_above_px"},
      {"lod: {policy: projected_size, full_above_px: 3, support_above_px: 4}",
       "s.yaml:4: lod.support_above_px: found 4, expected at most full_above_px (3)"},
      {"lod: {policy: error_budget, full_above_px: 3}",
       "s.yaml:4: lod.full_above_px: found full_above_px with policy error_budget, expected budget_ms or "
       "budget_work"},
      {"lod: {policy: distance, budget_work: 3}",
       "s.yaml:4: lod.budget_work: found budget_work with policy distance, expected"},
      {"lod: {full_within_m: 3, support_within_m: 2.5}",
       "s.yaml:4: lod.support_within_m: found 2.5, expected at least full_within_m (3)"},
      {"lod: {support_within_m: 2.5}",
       "s.yaml:4: lod.support_within_m: found 2.5, expected at least full_within_m (4)"},
      {"lod: {most_full: -1}", "s.yaml:4: lod.most_full: found -1, expected a whole number from 0"},
      {"lod: {most_suport: 1}", "s.yaml:4: lod.most_suport: found an unknown key, expected one of policy,"},
      {"lod: {model: sphere}", "s.yaml:4: lod.model: found sphere, expected one of auto, support, tables"},
      {"output: {trajectory: ../run.glb}",
       "s.yaml:4: output.trajectory: found ../run.glb, expected a file name"},
      {"output: {trajectory: run.obj}", "s.yaml:4: output.trajectory: found run.obj, expected"},
      {"check: {max_penetration_m: -1}", "s.yaml:4: check.max_penetration_m: found -1, expected"},
      {"check: {max_penetration_m: 0.1}",
       "s.yaml:4: check.max_penetration_m: found no ground but terrain and meshes, expected a plane, a box "
       "or"},
      {"viewpoints: [{look_at_m: [0, 0, 0]}]",
       "s.yaml:4: viewpoints[0].position_m: found no such key, expected"},
      {"viewpoints: [{position_m: [0, 0, 0], path: [{time_s: 1, position_m: [0, 0, 0]}]}]",
       "s.yaml:4: viewpoints[0].position_m: found a position beside a path, expected one of them"},
      {"contacts: [{between: [default, default]}]",
       "s.yaml:4: contacts[0]: found neither restitution nor friction, expected one of them at least"},
      {"viewpoints: [{path: [{time_s: 1, position_m: [0, 0, 0]}, {time_s: 1, position_m: [1, 0, 0]}]}]",
       "s.yaml:4: viewpoints[0].path[1].time_s: found 1, expected a number in (1,"},
      {"---\nversion: 1", "s.yaml:4: document: found a second document"},
      {"x: [1", "s.yaml:5: syntax: found"},
  };
  for (const BadScene& c : cases)
    EXPECT_TRUE(error_of(scene_with(c.text)).starts_with(c.message)) << error_of(scene_with(c.text)) << "\n"
                                                                     << c.message;
}

TEST_F(SceneFile, MaterialErrors) {
  const BadScene cases[] = {
      {"materials: {ice: {restitution: 1.5}}",
       "s.yaml:4: materials.ice.restitution: found 1.5, expected a number in [0, 1]"},
      {"materials: {ice: {restitution: -0.1}}", "s.yaml:4: materials.ice.restitution: found -0.1, expected"},
      {"materials: {ice: {friction: -0.1}}", "s.yaml:4: materials.ice.friction: found -0.1, expected"},
      {"materials: {ice: {density_kg_per_m3: 0}}",
       "s.yaml:4: materials.ice.density_kg_per_m3: found 0, expected a number above 0"},
      {"materials: {ice: {density: 1}}",
       "s.yaml:4: materials.ice.density: found an unknown key, expected one of restitution, friction, "
       "density_kg_per_m3 (did you mean \"density_kg_per_m3\"?)"},
      {"contacts: [{between: [default, ice]}]",
       "s.yaml:4: contacts[0].between[1]: found ice, expected one of default"},
      {"contacts: [{between: [default]}]",
       "s.yaml:4: contacts[0].between: found a list of 1, expected a list of 2"},
  };
  for (const BadScene& c : cases)
    EXPECT_TRUE(error_of(scene_with(c.text)).starts_with(c.message)) << error_of(scene_with(c.text)) << "\n"
                                                                     << c.message;
}

TEST_F(SceneFile, ShapeErrors) {
  write(
      "v 0 0 1\nv 0 0 -1\nv 1 0 0\nv 0 1 0\nv -1 0 0\nv 0 -1 0\n"
      "f 1 3 4\nf 1 4 5\nf 1 5 6\nf 1 6 3\nf 2 4 3\nf 2 5 4\nf 2 6 5\n",
      "open.obj");
  write(tetrahedron_obj(), "shut.obj");
  std::filesystem::create_directory(folder() / "folder.obj");
  const BadScene cases[] = {
      {"a: {box_m: [1, 0, 1]}", "s.yaml:2: shapes.a.box_m[1]: found 0, expected a number above 0"},
      {"a: {sphere_m: [1, 2]}", "s.yaml:2: shapes.a.sphere_m: found a list of 2, expected a number"},
      {"a: {l_m: [1, 1, 2, 1]}",
       "s.yaml:2: shapes.a.l_m: found 1, 1, 2, 1 (l), expected a bar width W below both legs"},
      {"a: {box_m: [1, 1, 1], sphere_m: 1}",
       "s.yaml:2: shapes.a: found box_m and sphere_m, expected only one of"},
      {"a: {material: default}", "s.yaml:2: shapes.a: found none, expected one of mesh, box_m"},
      {"a: {box_m: [1, 1, 1], faces: 9}",
       "s.yaml:2: shapes.a.faces: found an unknown key, expected one of box_m,"},
      {"a: {bx_m: [1, 1, 1]}", "s.yaml:2: shapes.a.bx_m: found an unknown key"},
      {"a: {box_m: [1, 1, 1], material: wod}",
       "s.yaml:2: shapes.a.material: found wod, expected one of default"},
      {"a: {box_m: [1, 1, 1], mass_kg: 0}",
       "s.yaml:2: shapes.a.mass_kg: found 0, expected a number in [1e-06, 1000000000000]"},
      {"a: {box_m: [1, 1, 1], mass_kg: 1e-7}",
       "s.yaml:2: shapes.a.mass_kg: found 1e-7, expected a number in [1e-06, 1000000000000]"},
      {"a: {box_m: [1, 1, 1], mass_kg: 1, inertia: [1e-9, 1e-9, 1e-9]}",
       "s.yaml:2: shapes.a.inertia: found a moment of 1e-09 m² over the mass (inertia of a), expected"},
      {"a: {box_m: [1, 1, 1], inertia: [1, 1, 1]}",
       "s.yaml:2: shapes.a.inertia: found an inertia without a mass, expected mass_kg"},
      {"a: {box_m: [1, 1, 1], mass_kg: 1, inertia: [1, 1, 100]}",
       "s.yaml:2: shapes.a.inertia: found an impossible inertia, of moments 1, 1 and 100, expected"},
      {"a: {box_m: [1, 1, 1], mass_kg: 1, inertia: [[1, 0, 0], [2, 1, 0], [0, 0, 1]]}",
       "s.yaml:2: shapes.a.inertia: found an impossible inertia, which is not symmetric, expected"},
      {"a: {box_m: [1, 1, 1], center_of_mass_m: [5, 0, 0]}",
       "s.yaml:2: shapes.a.center_of_mass_m: found (5, 0, 0) m (box:1,1,1: center of mass), expected a "
       "point"},
      {"a: {mesh: shut.obj, center_of_mass_m: [5, 0, 0]}",
       "s.yaml:2: shapes.a.center_of_mass_m: found (5, 0, 0) m (shut.obj: center of mass), expected a point"},
      {"a: {mesh: none.obj, obtain: ask me}", "s.yaml:2: shapes.a.mesh: found no none.obj in "},
      {"a: {mesh: folder.obj}", "s.yaml:2: shapes.a.mesh: found folder.obj, a folder, expected a mesh file"},
      {"a: {mesh: ../s.obj}",
       "s.yaml:2: shapes.a.mesh: found ../s.obj, a path out of the scene's folder, expected"},
      {"a: {mesh: /etc/passwd}",
       "s.yaml:2: shapes.a.mesh: found /etc/passwd, a path out of the scene's folder, expected"},
      {"a: {mesh: s.yaml}", "s.yaml:2: shapes.a.mesh: found "},
      {"a: {mesh: open.obj}", "s.yaml:2: shapes.a.mesh: found 3 open edges"},
      {"a: {mesh: shut.obj, size_m: 0}", "s.yaml:2: shapes.a.size_m: found 0, expected"},
      {"a: {mesh: shut.obj, faces: 3}", "s.yaml:2: shapes.a.faces: found 3, expected a whole number from 4"},
  };
  for (const BadScene& c : cases) {
    const std::string message = error_of(scene_with("", c.text));
    EXPECT_TRUE(message.starts_with(c.message)) << message << "\n" << c.message;
    EXPECT_NE(message.find(", expected "), std::string::npos) << message;
  }
  EXPECT_NE(error_of(scene_with("", "a: {mesh: none.obj, obtain: ask me}")).find("To obtain it: ask me"),
            std::string::npos);
  EXPECT_NE(error_of(scene_with("", "a: {bx_m: [1, 1, 1]}")).find("did you mean \"box_m\"?"),
            std::string::npos);
}

TEST_F(SceneFile, BodyErrors) {
  const BadScene cases[] = {
      {"{shape: crat, position_m: [0, 0, 0]}",
       "s.yaml:3: bodies[0].shape: found crat, expected one of crate (did you mean \"crate\"?)"},
      {"{position_m: [0, 0, 0]}", "s.yaml:3: bodies[0].shape: found no such key, expected"},
      {"{shape: crate}", "s.yaml:3: bodies[0]: found none, expected one of position_m, scatter"},
      {"{shape: crate, position_m: [0, 0, 0], orientation: [0, 0, 0, 0]}",
       "s.yaml:3: bodies[0].orientation: found [0, 0, 0, 0], expected a quaternion"},
      {"{shape: crate, position_m: [0, 0, 1e9]}", "s.yaml:3: bodies[0].position_m[2]: found 1e9, expected"},
      {"{shape: crate, position: [0, 0, 1]}", "s.yaml:3: bodies[0].position: found an unknown key"},
      {"{shape: crate, position_m: [0, 0, 1], level: fully}",
       "s.yaml:3: bodies[0].level: found fully, expected one of auto, full, statistical, support, tables "
       "(did you mean \"full\"?)"},
      {"{shape: crate, position_m: [0, 0, 1], mass_kg: 0}", "s.yaml:3: bodies[0].mass_kg: found 0, expected"},
      {"{shape: crate, scatter: {count: 0, box_m: [[0, 0, 0], [1, 1, 1]]}}",
       "s.yaml:3: bodies[0].scatter.count: found 0, expected"},
      {"{shape: crate, scatter: {count: 3}}",
       "s.yaml:3: bodies[0].scatter: found none, expected one of box_m, cylinder"},
      {"{shape: crate, scatter: {count: 3, box_m: [[0, 0, 1], [1, 1, 0]]}}",
       "s.yaml:3: bodies[0].scatter.box_m: found a second corner below"},
      {"{shape: crate, scatter: {count: 99, box_m: [[0, 0, 0], [1, 1, 1]]}}",
       "s.yaml:3: bodies[0].scatter: found 99 bodies of radius 0.866 m, expected"},
      {"{shape: crate, scatter: {count: 1, on_ground: yes, box_m: [[0, 0, 0], [1, 1, 1]]}}",
       "s.yaml:3: bodies[0].scatter.on_ground: found yes, expected one of false, true"},
      {"{shape: crate, scatter: {count: 1, lying: true, box_m: [[0, 0, 0], [1, 1, 1]]}}",
       "s.yaml:3: bodies[0].scatter.lying: found no ground below the region that they could lie on, "
       "expected"},
      {"{shape: crate, scatter: {count: 1, on_ground: true, box_m: [[0, 0, 0], [1, 1, 1]]}}",
       "s.yaml:3: bodies[0].scatter.on_ground: found no ground below the region, expected"},
      {"{shape: crate, scatter: {count: 1, on_ground: true, lying: true, box_m: [[0, 0, 0], [1, 1, 1]]}}",
       "s.yaml:3: bodies[0].scatter.lying: found lying beside on_ground, expected one of them"},
      {"{shape: crate, asleep: 1, position_m: [0, 0, 1]}",
       "s.yaml:3: bodies[0].asleep: found 1, expected one of false, true"},
      {"{shape: crate, scatter: {count: 3000000, box_m: [[0, 0, 0], [1, 1, 1]]}}",
       "s.yaml:3: bodies[0].scatter.count: found 3000000, expected"},
  };
  for (const BadScene& c : cases) {
    const std::string message = error_of(scene_with("", "crate: {box_m: [1, 1, 1]}", c.text));
    EXPECT_TRUE(message.starts_with(c.message)) << message << "\n" << c.message;
  }
  const std::string crumb = error_of(scene_with("", "crate: {box_m: [1e-4, 1e-4, 1e-4]}"));
  EXPECT_TRUE(crumb.starts_with("s.yaml:3: bodies[0].shape: found 1e-09 kg (mass), expected 1e-06 …"))
      << crumb;
}

TEST_F(SceneFile, TooManyBodiesInAll) {
  const std::string one = "{shape: crate, position_m: [0, 0, 0]}";
  const std::string message =
      error_of(scene_with("", "crate: {box_m: [1, 1, 1]}", one + ", " + one + ", " + one),
               {.mesh_paths = {}, .seed = {}, .max_bodies = 2});
  EXPECT_EQ(message, "s.yaml:3: bodies[2]: found 3 bodies, expected at most 2");
}

TEST_F(SceneFile, MissingSectionsAndFiles) {
  EXPECT_EQ(error_of("shapes: {}\nbodies: []\n"),
            "s.yaml:1: version: found no such key, expected it to be given");
  EXPECT_EQ(error_of("version: 2\nbodies: []\n"),
            "s.yaml:1: version: found 2, expected a whole number from 1 to 1");
  EXPECT_EQ(error_of("version: 1\n"), "s.yaml:1: bodies: found no such key, expected it to be given");
  EXPECT_EQ(
      error_of("just text"),
      "s.yaml:1: scene: found just text, expected a map with version, step, materials, contacts, shapes, "
      "ground, bodies, ragdolls, joints, viewpoints, lod, output, check");
  EXPECT_THROW(load_scene(folder() / "none.yaml"), InputError);
  EXPECT_THROW(load_scene(folder()), InputError);
}

TEST_F(SceneFile, GroundErrors) {
  write("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "face.obj");
  const BadScene cases[] = {
      {"ground: [{plane: {normal: [0, 0, 0]}}]",
       "s.yaml:4: ground[0].plane.normal: found [0, 0, 0], expected a direction"},
      {"ground: [{plane: {}, box: {}}]", "s.yaml:4: ground[0]: found plane and box, expected only one of"},
      {"ground: [{plane: {}, size_m: 1}]", "s.yaml:4: ground[0].size_m: found an unknown key"},
      {"ground: [{box: {sides_m: [1, -1, 1]}}]", "s.yaml:4: ground[0].box.sides_m[1]: found -1, expected"},
      {"ground: [{mesh: ../x.obj}]",
       "s.yaml:4: ground[0].mesh: found ../x.obj, a path out of the scene's folder"},
      {"ground: [{mesh: face.obj}]",
       "s.yaml:4: ground[0].mesh: found 1 faces (static mesh), expected two or more, with an area"},
      {"ground: [{terrain: {cells: [1, 1], size_m: [2, 2]}}]",
       "s.yaml:4: ground[0].terrain: found none, expected one of hills, heights_m"},
      {"ground: [{terrain: {cells: [0, 1], size_m: [2, 2], hills: []}}]",
       "s.yaml:4: ground[0].terrain.cells[0]: found 0, expected a whole number from 1 to 1000"},
      {"ground: [{terrain: {cells: [1, 1], size_m: [2, 2], heights_m: [[0, 0], [0]]}}]",
       "s.yaml:4: ground[0].terrain.heights_m[1]: found a list of 1, expected a list of 2"},
      {"ground: [{terrain: {cells: [1, 1], size_m: [2, 2], heights_m: [[0, 0]]}}]",
       "s.yaml:4: ground[0].terrain.heights_m: found a list of 1, expected a list of 2"},
      {"ground: [{terrain: {cells: [1, 1], size_m: [2, 2], hills: [{height_m: 1, length_m: [0, 1]}]}}]",
       "s.yaml:4: ground[0].terrain.hills[0].length_m[0]: found 0, expected"},
      {"ground: [{stairs: {steps: 0, rise_m: 1, run_m: 1, width_m: 1}}]",
       "s.yaml:4: ground[0].stairs.steps: found 0, expected a whole number from 1"},
      {"ground: [{stairs: {steps: 3, rise_m: 1, run_m: 1}}]",
       "s.yaml:4: ground[0].stairs.width_m: found no such key"},
      {"ground: [{stairs: {steps: 3, rise_m: 1, run_m: 1, width_m: 1}, size_m: 2}]",
       "s.yaml:4: ground[0].size_m: found an unknown key"},
      {"ground: {}", "s.yaml:4: ground: found a map, expected a list"},
  };
  for (const BadScene& c : cases)
    EXPECT_TRUE(error_of(scene_with(c.text)).starts_with(c.message)) << error_of(scene_with(c.text)) << "\n"
                                                                     << c.message;
}

// A symbolic link must not lead out of the folder either; a mesh path is as good as the folder.
TEST_F(SceneFile, LinksAndMeshPaths) {
  const std::filesystem::path outside = folder() / "outside", inside = folder() / "inside";
  std::filesystem::create_directories(outside);
  std::filesystem::create_directories(inside);
  std::ofstream(outside / "t.obj") << tetrahedron_obj();
  std::filesystem::create_symlink(outside / "t.obj", inside / "link.obj");
  const auto load_with = [&](const std::string& mesh, std::vector<std::filesystem::path> paths) {
    std::ofstream(inside / "s.yaml") << scene_with("", "a: {mesh: " + mesh + "}",
                                                   "{shape: a, position_m: [0, 0, 2]}");
    return load_scene(inside / "s.yaml", {.mesh_paths = std::move(paths), .seed = {}});
  };
  EXPECT_THROW(load_with("link.obj", {}), InputError);
  EXPECT_THROW(load_with("t.obj", {}), InputError);
  EXPECT_EQ(load_with("t.obj", {outside}).bodies.size(), 1u);
  EXPECT_EQ(load_with("link.obj", {outside}).bodies.size(), 1u);
}

}  // namespace
}  // namespace lodestone::scene_file_test
