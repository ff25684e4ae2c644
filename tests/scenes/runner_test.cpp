#include "scenes/runner.h"

#include <cmath>
#include <fstream>
#include <limits>
#include <numeric>

#include "tests/scenes/scene_fixture.h"

namespace lodestone {
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
  const RunResult result = run_scene(load(kFalling), {.out = folder() / "out"});
  EXPECT_EQ(result.steps, 50);
  EXPECT_EQ(result.bodies, 2);
  EXPECT_EQ(result.reports.size(), 50u);
  EXPECT_EQ(result.last().full, 2);
  EXPECT_TRUE(result.finite);
  EXPECT_GT(result.step_ms.p50, 0);
  EXPECT_GE(result.step_ms.max, result.step_ms.p99);
  EXPECT_TRUE(std::filesystem::exists(folder() / "out/run.glb"));
  std::ifstream csv(folder() / "out/steps.csv");
  EXPECT_EQ(std::count(std::istreambuf_iterator<char>(csv), {}, '\n'), 51);
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

TEST_F(Runner, RefusesSettingsOutOfRange) {
  const Scene scene = load(kFalling);
  for (double dt : {0.0, -0.01, 0.2, std::numeric_limits<double>::quiet_NaN()}) EXPECT_THROW(run_scene(scene, {.dt_s = dt}), InputError);
  EXPECT_THROW(run_scene(scene, {.steps = 0}), InputError);
  EXPECT_THROW(run_scene(scene, {.threads = 0}), InputError);
  write("", "a_file");
  EXPECT_THROW(run_scene(scene, {.steps = 1, .out = folder() / "a_file"}), InputError);
}

TEST_F(Runner, RefusesATrajectoryBeyondFourGigabytes) {
  const Scene scene = load(kFalling);
  try {
    run_scene(scene, {.steps = 2'000'000'000, .out = folder() / "out"});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("every_n_steps: found 2"), std::string::npos) << error.what();
  }
}

// The viewpoint goes from one ball to the other: the first is full and then statistical, the second the other way round.
TEST_F(Runner, ViewpointsMoveAndDecideLevels) {
  const Scene scene = load(R"(version: 1
step: {dt_s: 0.01, steps: 100, full_substeps: 1, gravity_m_per_s2: [0, 0, 0]}
shapes: {ball: {sphere_m: 0.1}}
bodies: [{shape: ball, position_m: [0, 0, 1]}, {shape: ball, position_m: [10, 0, 1]}]
viewpoints: [{path: [{time_s: 0, position_m: [0, 0, 1]}, {time_s: 0.9, position_m: [10, 0, 1]}]}]
lod: {full_within_m: 2, min_dwell_frames: 5}
)");
  int asked = 0;
  const auto none = [&](const Shape&, const ContactLaw&) { return ++asked, std::shared_ptr<const Signature>{}; };
  const RunResult result = run_scene(scene, {.signatures = none});
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
  run_scene(load(kFalling), {.steps = 4, .progress = [&](int step, int) { steps.push_back(step); }});
  EXPECT_EQ(steps, (std::vector{1, 2, 3, 4}));
}

TEST(TimeSummary, Percentiles) {
  std::vector<double> sample(101);
  std::iota(sample.rbegin(), sample.rend(), 0.0);
  const TimeSummary summary = summarize(sample);
  EXPECT_EQ(summary.p50, 50);
  EXPECT_EQ(summary.p95, 95);
  EXPECT_EQ(summary.p99, 99);
  EXPECT_EQ(summary.mean, 50);
  EXPECT_EQ(summary.max, 100);
  EXPECT_EQ(summarize({}).max, 0);
  EXPECT_EQ(summarize(std::vector{7.0}).p95, 7);
}

}  // namespace
}  // namespace lodestone
