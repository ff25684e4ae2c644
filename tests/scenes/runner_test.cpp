#include "scenes/runner.h"

#include <ode/ode.h>

#include <algorithm>
#include <fstream>
#include <limits>

#include "signature/measure/measure.h"
#include "tests/scenes/scene_fixture.h"
#include "tools/memory.h"

namespace lodestone::runner_test {
namespace {

// Balls and boxes at the full level need no signature, so these runs are quick.
const char* const kFalling = R"(version: 1
step: {dt_s: 0.01, steps: 50, full_substeps: 2}
shapes: {ball: {sphere_m: 0.1}, crate: {box_m: [0.2, 0.2, 0.2]}}
ground: [{plane: {normal: [0, 0, 1], offset_m: 0}}]
bodies:
  - {shape: ball, position_m: [0, 0, 0.5], level: full, name: ball}
  - {shape: crate, position_m: [3, 0, 0.5], level: full, name: crate}
output: {trajectory: run.glb, every_n_steps: 2}
check: {max_penetration_m: 0.05, all_asleep_by_s: 60}
)";

using Runner = SceneFixture;

TEST_F(Runner, ReportsEveryStepAndWritesFiles) {
  const RunResult result = run_scene(load(kFalling), {.out = folder() / "out", .keep_steps = true});
  EXPECT_EQ(result.steps, 50);
  EXPECT_EQ(result.bodies, 2);
  EXPECT_EQ(result.reports.size(), 50u);
  EXPECT_EQ(result.last().full, 2);
  EXPECT_TRUE(result.finite);
  EXPECT_GT(result.step_ms.p50, 0);
  EXPECT_GE(result.step_ms.max, result.step_ms.p99);
  EXPECT_TRUE(std::filesystem::exists(folder() / "out/run.glb"));
  std::ifstream csv(folder() / "out/steps.csv");
  std::string heading;
  std::getline(csv, heading);
  EXPECT_TRUE(heading.starts_with("step,time_s,total_ms,choose_ms,"));
  EXPECT_TRUE(heading.ends_with(",energy_j,penetration_m,support,tables,predicted_ms,measured_ms"));
  int rows = 0;
  for (std::string row; std::getline(csv, row); ++rows)
    EXPECT_EQ(std::ranges::count(row, ','), std::ranges::count(heading, ',')) << row;
  EXPECT_EQ(rows, 50);
}

TEST_F(Runner, WritesNothingUnlessAsked) {
  const RunResult result = run_scene(load(kFalling), {.steps = 3});
  EXPECT_EQ(result.steps, 3);
  EXPECT_TRUE(result.trajectory.empty());
  EXPECT_FALSE(std::filesystem::exists("steps.csv"));
}

TEST_F(Runner, EnergyIsThatOfTheStart) {
  const Scene scene = load(kFalling);
  const RunResult result = run_scene(scene, {.steps = 20});
  const double volume = scene.shapes.at("ball")->volume + scene.shapes.at("crate")->volume;
  EXPECT_NEAR(result.energy_start_j, 1000 * volume * 9.81 * 0.5, 1e-9);
  EXPECT_LE(result.energy_max_j, result.energy_start_j * 1.001);
  EXPECT_LT(result.energy_end_j, result.energy_start_j);
  EXPECT_GT(result.energy_end_j, 0.0);
}

TEST_F(Runner, SameSceneSameHash) {
  const Scene scene = load(kFalling);
  const std::uint64_t first = run_scene(scene).state_hash;
  EXPECT_EQ(run_scene(scene).state_hash, first);
  EXPECT_NE(run_scene(scene, {.steps = 49}).state_hash, first);
}

TEST_F(Runner, ChecksAreDecidedOnlyOnceTheyCanBe) {
  const RunResult result = run_scene(load(kFalling), {.steps = 5});
  ASSERT_EQ(result.checks.size(), 2u);
  EXPECT_TRUE(result.checks[0].pass && result.checks[0].decided);
  EXPECT_EQ(result.checks[1].name, "all_asleep_by_s");
  EXPECT_TRUE(result.checks[1].pass);
  EXPECT_FALSE(result.checks[1].decided);
}

TEST_F(Runner, ChecksCanFail) {
  Scene scene = load(kFalling);
  scene.checks.all_asleep_by_s = 0.1;
  scene.bodies[0].definition.state.position.z() = 0.08;  // 2 cm deep at the start
  scene.checks.max_penetration_m = 1e-6;
  const RunResult result = run_scene(scene, {.steps = 30});
  EXPECT_FALSE(result.checks[0].pass);
  EXPECT_GT(result.checks[0].value, 1e-4);
  EXPECT_FALSE(result.checks[1].pass);
  EXPECT_TRUE(result.checks[1].decided);
}

TEST_F(Runner, WhoIsAwakeWhenTheTimeIsUpFailsTheCheck) {
  Scene scene = load(kFalling);
  scene.checks.all_asleep_by_s = 6 * scene.step.dt_s;
  const RunResult result = run_scene(scene, {.steps = 6});
  EXPECT_FALSE(result.checks[1].pass);
  EXPECT_TRUE(result.checks[1].decided);
}

std::shared_ptr<const Signature> coarse_signature(const Shape& shape, const ContactLaw&) {
  SignatureSettings coarse;
  coarse.n_theta = 4, coarse.n_phi = 4, coarse.n_alpha = 6, coarse.trials_per_cell = 8,
  coarse.height_trials = 100, coarse.settling_trials = 20, coarse.clips = 10;
  return std::make_shared<const Signature>(measure_signature(shape, coarse, 1));
}

// A crate that starts 2 cm deep, and one at `tables` that starts 3 cm deep.
TEST_F(Runner, SpheresOfTablesHaveABoundOfTheirOwn) {
  Scene scene = load(R"(version: 1
step: {dt_s: 0.001, steps: 1, full_substeps: 1}
shapes: {crate: {box_m: [0.2, 0.2, 0.2]}}
ground: [{plane: {normal: [0, 0, 1], offset_m: 0}}]
bodies:
  - {shape: crate, position_m: [0, 0, 0.08], level: full}
  - {shape: crate, position_m: [3, 0, 0.07], velocity_m_per_s: [0, 0, -1], level: tables}
check: {max_penetration_m: 0.025, max_tables_penetration_m: 0.04}
)");
  const RunSettings settings{.signatures = coarse_signature};
  const auto checks = run_scene(scene, settings).checks;
  ASSERT_EQ(checks.size(), 2u);
  EXPECT_NEAR(checks[0].value, 0.02, 2e-3);
  EXPECT_GT(checks[1].value, 0.025);
  EXPECT_TRUE(checks[0].pass && checks[1].pass);
  scene.checks.max_tables_penetration_m.reset();
  const auto one = run_scene(scene, settings).checks;
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(one[0].value, checks[1].value);
  EXPECT_FALSE(one[0].pass);
}

TEST_F(Runner, DepthInABoxOfTheGroundIsChecked) {
  const Scene scene = load(R"(version: 1
step: {dt_s: 0.001, steps: 1, full_substeps: 1}
shapes: {crate: {box_m: [0.2, 0.2, 0.2]}}
ground: [{box: {sides_m: [4, 4, 1], position_m: [0, 0, -0.5]}}]
bodies: [{shape: crate, position_m: [0, 0, 0.05], level: full}]
check: {max_penetration_m: 0.025}
)");
  const auto checks = run_scene(scene).checks;
  ASSERT_EQ(checks.size(), 1u);
  EXPECT_NEAR(checks[0].value, 0.05, 2e-3);
  EXPECT_FALSE(checks[0].pass);
}

TEST_F(Runner, RefusesSettingsOutOfRange) {
  const Scene scene = load(kFalling);
  for (double dt : {0.0, -0.01, 0.2, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THROW(run_scene(scene, {.dt_s = dt}), InputError);
  EXPECT_THROW(run_scene(scene, {.steps = 0}), InputError);
  EXPECT_THROW(run_scene(scene, {.threads = 0}), InputError);
  for (double budget :
       {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(run_scene(scene, {.budget_ms = budget}), InputError);
    EXPECT_THROW(run_scene(scene, {.budget_work = budget}), InputError);
  }
  EXPECT_THROW(run_scene(scene, {.budget_ms = 4.0, .budget_work = 2000.0}), InputError);
  write("", "a_file");
  EXPECT_THROW(run_scene(scene, {.steps = 1, .out = folder() / "a_file"}), InputError);
}

TEST_F(Runner, RefusesATrajectoryBeyondFourGigabytes) {
  const Scene scene = load(kFalling);
  const std::string message =
      testing::message_of([&] { run_scene(scene, {.steps = 2'000'000'000, .out = folder() / "out"}); });
  EXPECT_NE(message.find("every_n_steps: found 2"), std::string::npos) << message;
}

TEST_F(Runner, AnEarlierRunsSecondFutureIsNotThisOnes) {
  const std::filesystem::path fork = folder() / "out/fork.play";
  Scene scene = load(kFalling);
  for (SceneBody& body : scene.bodies) body.definition.level = LevelChoice::automatic;
  const auto none = [](const Shape&, const ContactLaw&) { return std::shared_ptr<const Signature>(); };
  run_scene(
      scene,
      {.steps = 6, .level = LevelChoice::full, .fork_step = 3, .out = folder() / "out", .signatures = none});
  EXPECT_TRUE(std::filesystem::exists(fork));
  run_scene(scene, {.steps = 6, .out = folder() / "out", .signatures = none});
  EXPECT_FALSE(std::filesystem::exists(fork));
}

TEST_F(Runner, WritesOverNothingThatItReadsOrWrites) {
  std::filesystem::create_directories(folder() / "meshes");
  std::ofstream(folder() / "meshes/a.obj") << tetrahedron_obj();
  std::ofstream(folder() / "meshes/run.glb") << tetrahedron_obj();
  Scene scene = load(R"(version: 1
shapes: {a: {mesh: meshes/a.obj, size_m: 1}}
ground: [{mesh: meshes/a.obj}]
bodies: [{shape: a, position_m: [0, 0, 3], level: full}]
output: {trajectory: run.glb}
)");
  EXPECT_EQ(scene.mesh_files.size(), 2u);
  scene.mesh_files.push_back(folder() / "meshes/run.glb");
  const std::string read = "found a file that the scene is made of",
                    written = "found a file that the run writes, too";
  const auto expect_refused = [&](const RunSettings& settings, const std::string& words) {
    const std::string message = testing::message_of([&] { run_scene(scene, settings); });
    EXPECT_NE(message.find(words), std::string::npos) << message;
  };
  expect_refused({.steps = 1, .record = folder() / "meshes/../meshes/a.obj"}, read);
  expect_refused({.steps = 1, .record = scene.file}, read);
  expect_refused({.steps = 1, .out = folder() / "meshes"}, read);
  for (const char* file : {"out/run.play", "out/steps.csv", "out/run.glb"})
    expect_refused({.steps = 1, .out = folder() / "out", .record = folder() / file}, written);
  EXPECT_FALSE(std::filesystem::exists(folder() / "out"));
  EXPECT_EQ(testing::bytes_of(folder() / "meshes/a.obj"), tetrahedron_obj());
  EXPECT_EQ(testing::bytes_of(folder() / "meshes/run.glb"), tetrahedron_obj());
  EXPECT_EQ(run_scene(scene, {.steps = 1, .out = folder() / "out", .record = "/dev/null"}).steps, 1);
}

// The viewpoint goes from one ball to the other: the first is full and then statistical, the second the other
// way round.
TEST_F(Runner, ViewpointsMoveAndDecideLevels) {
  const Scene scene = load(R"(version: 1
step: {dt_s: 0.01, steps: 100, full_substeps: 1, gravity_m_per_s2: [0, 0, 0]}
shapes: {ball: {sphere_m: 0.1}}
bodies: [{shape: ball, position_m: [0, 0, 1]}, {shape: ball, position_m: [10, 0, 1]}]
viewpoints: [{path: [{time_s: 0, position_m: [0, 0, 1]}, {time_s: 0.9, position_m: [10, 0, 1]}]}]
lod: {full_within_m: 2, min_dwell_frames: 5}
)");
  int asked = 0;
  const auto none = [&](const Shape&, const ContactLaw&) {
    return ++asked, std::shared_ptr<const Signature>{};
  };
  const RunResult result = run_scene(scene, {.signatures = none, .keep_steps = true});
  EXPECT_EQ(result.reports.front().full, 1);
  EXPECT_EQ(result.reports[50].full, 0);
  EXPECT_EQ(result.last().full, 1);
  EXPECT_EQ(result.transitions, 2);
  EXPECT_EQ(result.promotions, 1);
  EXPECT_EQ(asked, 1);
  EXPECT_EQ(run_scene(scene, {.level = LevelChoice::full}).transitions, 0);
}

TEST_F(Runner, FollowsProgress) {
  std::vector<int> steps;
  run_scene(load(kFalling),
            {.steps = 4, .progress = [&](const RunProgress& run) { steps.push_back(run.step); }});
  EXPECT_EQ(steps, (std::vector{1, 2, 3, 4}));
}

// A viewpoint that looks at one of two full balls and past the other.
TEST_F(Runner, CountsFullBodiesInThePicture) {
  const auto scene_of = [&](const std::string& position) {
    return load(R"(version: 1
step: {dt_s: 0.1, steps: 10, full_substeps: 1, gravity_m_per_s2: [0, 0, 0]}
shapes: {ball: {sphere_m: 0.1}}
bodies:
  - {shape: ball, position_m: [0, 0, 1], level: full}
  - {shape: ball, position_m: [9, 0, 1], level: full}
  - {shape: ball, position_m: [0, 1, 1], level: support}
viewpoints: [{look_at_m: [0, 0, 1], )" +
                position + "}]\n");
  };
  const auto none = [](const Shape&, const ContactLaw&) { return std::shared_ptr<const Signature>{}; };
  const auto seen = run_scene(scene_of("position_m: [0, -3, 1]"), {.signatures = none}).in_picture;
  ASSERT_TRUE(seen);
  EXPECT_EQ(seen->min_full, 1);
  EXPECT_EQ(seen->mean_full, 1.0);
  // Far away both are in it; the last of the six steps that end at .5 s or later begins at .9 s.
  const auto moved =
      run_scene(
          scene_of("path: [{time_s: 0.85, position_m: [0, -3, 1]}, {time_s: 0.86, position_m: [0, -90, 1]}]"),
          {.signatures = none})
          .in_picture;
  ASSERT_TRUE(moved);
  EXPECT_EQ(moved->min_full, 1);
  EXPECT_NEAR(moved->mean_full, 7.0 / 6, 1e-12);
  EXPECT_FALSE(run_scene(scene_of("position_m: [0, -3, 1]"), {.steps = 4, .signatures = none}).in_picture);
  EXPECT_FALSE(run_scene(load(kFalling), {.steps = 60}).in_picture);
}

TEST_F(Runner, ABudgetReplacesTheScenesPolicy) {
  const Scene scene = load(kFalling);
  EXPECT_FALSE(run_scene(scene, {.steps = 3}).budget);
  const RunResult timed = run_scene(scene, {.steps = 20, .budget_ms = 5.0}),
                  worked = run_scene(scene, {.steps = 20, .budget_work = 500.0});
  ASSERT_TRUE(timed.budget && worked.budget);
  EXPECT_EQ(timed.budget->budget_ms, 5.0);
  EXPECT_EQ(timed.budget->steps, 11);
  EXPECT_EQ(timed.budget->mean_bodies[std::size_t(Rung::full)], 2.0);  // forced
  EXPECT_EQ(worked.budget->budget_work, 500.0);
  EXPECT_FALSE(worked.budget->over);
  EXPECT_GT(timed.processor_ms.max, 0.0);
}

// What a run holds does not grow with its steps, but for the times that are kept exactly.
TEST_F(Runner, HoldsNoStepsUnlessAsked) {
  RunSettings settings{.steps = 3000};
  double early = 0, late = 0;
  settings.watch = [&](const WatchedStep& step) {
    if (step.manager.report().step == 1000) early = heap_bytes();
    if (step.manager.report().step == 3000) late = heap_bytes();
  };
  const RunResult result = run_scene(load(kFalling), settings);
  EXPECT_EQ(result.steps, 3000);
  EXPECT_TRUE(result.reports.empty());
  EXPECT_TRUE(result.step_processor_ms.empty());
  EXPECT_EQ(result.last().step, 3000);
  EXPECT_GT(result.mean_ms(&StageTimes::total_ms), 0.0);
  EXPECT_LT(
      late - early,
      2.0 * 2 * 8 * 4096);  // two series of doubles, in capacities of powers of two; reports would be 1.2 MB
  settings.keep_steps = true, settings.steps = 5;
  EXPECT_EQ(run_scene(load(kFalling), settings).reports.size(), 5u);
}

TEST_F(Runner, StopsAfterAStep) {
  int asked = 0;
  const RunResult result = run_scene(load(kFalling), {.stop = [&] { return ++asked == 3; }});
  EXPECT_EQ(result.steps, 3);
  EXPECT_TRUE(result.incomplete);
  EXPECT_FALSE(run_scene(load(kFalling), {.steps = 3, .stop = [] { return false; }}).incomplete);
  const RunResult one = run_scene(load(kFalling), {.stop = [] { return true; }});
  EXPECT_EQ(one.steps, 1);
}

// ODE does not go on with a body of next to no mass under another.
const char* const kStack = R"(version: 1
shapes: {crate: {box_m: [0.3, 0.3, 0.3]}}
ground: [{plane: {normal: [0, 0, 1], offset_m: 0}}]
bodies:
  - {shape: crate, position_m: [0, 0, 0.14], level: full}
  - {shape: crate, position_m: [0.03, 0, 0.42], level: full}
  - {shape: crate, position_m: [0.06, 0, 0.7], level: full}
  - {shape: crate, position_m: [0.09, 0, 0.98], level: full}
)";

void lighten_third(const WatchedStep& step) {
  dxBody* const third = step.manager.ode_body(step.bodies[2]);
  if (!third) return;
  dMass light;
  dMassSetBoxTotal(&light, 1e-30, 0.3, 0.3, 0.3);
  dBodySetMass(third, &light);
}

TEST_F(Runner, WhereOdeGivesUpWhatThereIsIsKept) {
  const RunSettings settings{.steps = 300, .out = folder() / "out", .watch = lighten_third};
  try {
    run_scene(load(kStack), settings);
    FAIL() << "ODE went on";
  } catch (const FailedRun& failed) {
    const RunResult& result = failed.result();
    EXPECT_GE(result.steps, 1);
    EXPECT_LT(result.steps, 300);
    EXPECT_TRUE(result.incomplete);
    ASSERT_TRUE(result.failure);
    EXPECT_STREQ(result.failure->what(), failed.what());
    EXPECT_EQ(result.last().full, 4);
    const std::string csv = testing::bytes_of(folder() / "out/steps.csv");
    EXPECT_EQ(std::ranges::count(csv, '\n'), 1 + result.steps);
    EXPECT_TRUE(std::filesystem::exists(result.playback));
  }
}

TEST_F(Runner, WhereOdeGivesUpInASecondFutureTheFirstIsKept) {
  const RunSettings settings{
      .steps = 60, .level = LevelChoice::full, .fork_step = 20, .watch = lighten_third};
  Scene scene = load(kStack);
  for (SceneBody& body : scene.bodies) body.definition.level = LevelChoice::support;
  try {
    run_scene(scene, settings);
    FAIL() << "ODE went on";
  } catch (const FailedRun& failed) {
    EXPECT_EQ(failed.result().steps, 60);
    ASSERT_TRUE(failed.result().fork);
    EXPECT_LT(failed.result().fork->result.steps, 40);
  }
}

}  // namespace
}  // namespace lodestone::runner_test
