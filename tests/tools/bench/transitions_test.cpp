// `bench transitions`: a scene's changes of rung are found, and what is seen of them is said.
#include <nlohmann/json.hpp>

#include "tests/scenes/scene_fixture.h"
#include "tests/tools/cli_fixture.h"
#include "tools/bench/rungs_bench.h"
#include "tools/bench/transitions_bench.h"

namespace lodestone::transitions_test {
namespace {

// Crates fall beside each other; the camera comes near.
constexpr const char* kScene = R"(version: 1
step: {dt_s: 0.016667, seed: 7, steps: 90}
shapes: {crate: {box_m: [0.2, 0.3, 0.4]}}
ground: [{plane: {normal: [0, 0, 1], offset_m: 0}}, {box: {sides_m: [1, 1, 0.2], position_m: [0, 0, 0.1]}}, {terrain: {cells: [4, 4], size_m: [2, 2], position_m: [5, 0, 0.5], hills: [{height_m: 0.1, length_m: [2, 2]}]}}]
bodies: [{shape: crate, scatter: {count: 16, box_m: [[-1, -1, 0.6], [1, 1, 2]], seed: 3}}]
viewpoints: [{look_at_m: [0, 0, 0.3], path: [{time_s: 0, position_m: [0, -9, 1]}, {time_s: 1.5, position_m: [0, -1.5, 1]}]}]
lod: {policy: distance, full_within_m: 3, support_within_m: 6}
)";

TEST(DistanceBeyond, IsWhatNoVelocityBetweenTheTwoExplains) {
  const Vec3 from(1, 0, 0), to(-1, 0, 0);
  EXPECT_DOUBLE_EQ(distance_beyond({0.3, 0, 0}, from, to), 0.0);
  EXPECT_DOUBLE_EQ(distance_beyond({0.3, 0.2, 0}, from, to), 0.2);
  EXPECT_DOUBLE_EQ(distance_beyond({1.5, 0, 0}, from, to), 0.5);
  EXPECT_DOUBLE_EQ(distance_beyond({1, 0, 2}, from, from), 2.0);
}

TEST(TransitionFigures, UnseenIsWhatItSays) {
  TransitionFigures within;
  within.changed.p99_px = 1.0, within.with_bodies.max = 0.05, within.gained_j = 0.001, within.scene_j = 1.0;
  EXPECT_TRUE(is_unseen(within));
  for (const auto& spoil : {+[](TransitionFigures& f) { f.changed.p99_px = 1.01; },
                            +[](TransitionFigures& f) { f.with_bodies.max = 0.051; },
                            +[](TransitionFigures& f) { f.with_ground.max = 0.051; },
                            +[](TransitionFigures& f) { f.gained_j = 0.00101; }}) {
    TransitionFigures beyond = within;
    spoil(beyond);
    EXPECT_FALSE(is_unseen(beyond));
  }
}

using TransitionsBench = SceneFixture;

TEST_F(TransitionsBench, FindsEveryChangeOfTheRun) {
  const Scene scene = load(kScene);
  const RunResult run = run_scene(scene);
  const TransitionFigures all = bench_transitions(scene, {}, 0.0), late = bench_transitions(scene, {}, 0.75);
  EXPECT_EQ(all.changes, run.transitions);
  EXPECT_GT(all.with_bodies.promotions, 0);
  EXPECT_EQ(all.with_bodies.promotions, all.with_ground.promotions);
  EXPECT_GT(late.changes, 0);
  EXPECT_LT(late.changes, all.changes);
  EXPECT_GT(all.others.moves, all.changed.moves);
  EXPECT_LE(all.changed.p50_px, all.changed.p99_px);
  EXPECT_LE(all.changed.p99_px, all.changed.max_px);
  EXPECT_LE(all.net_j, all.gained_j);
  EXPECT_GT(all.scene_j, 0.0);
  EXPECT_LE(all.scene_j, run.energy_start_j) << "all ground is at the origin's height or above";
}

TEST_F(TransitionsBench, NeedsAViewpoint) {
  Scene scene = load(kScene);
  scene.viewpoints.clear();
  EXPECT_THROW(bench_transitions(scene, {}, 0.0), InputError);
}

// A body that is put down into another, and into the ground, and then becomes full.
TEST_F(TransitionsBench, SeesAnOverlapAtPromotion) {
  const Scene scene = load(R"(version: 1
step: {dt_s: 0.016667, seed: 7, steps: 30}
shapes: {crate: {box_m: [0.2, 0.2, 0.2]}}
ground: [{plane: {normal: [0, 0, 1], offset_m: 0}}]
bodies:
  - {shape: crate, position_m: [0, 0, 0.0985], asleep: true}
  - {shape: crate, position_m: [0.199, 0, 0.0985], asleep: true}
viewpoints: [{look_at_m: [0, 0, 0.1], path: [{time_s: 0, position_m: [0, -9, 1]}, {time_s: 0.4, position_m: [0, -1, 1]}]}]
lod: {policy: distance, full_within_m: 4, min_dwell_frames: 0}
)");
  const TransitionFigures figures = bench_transitions(scene, {}, 0.0);
  ASSERT_EQ(figures.with_bodies.promotions, 2);
  EXPECT_NEAR(figures.with_bodies.max, 0.005, 1e-6);
  EXPECT_NEAR(figures.with_ground.max, 0.0075, 1e-6);
  EXPECT_LE(figures.changed.max_px, 1.0);
}

class TransitionsCommand : public testing::CliTest {};

TEST_F(TransitionsCommand, PrintsJsonAndSaysWhatIsSeen) {
  std::ofstream(at("scene.yaml")) << kScene;
  const auto ended = run("bench transitions " + name("scene.yaml") + " --json --threads 1");
  EXPECT_TRUE(ended.exit_code == 0 || ended.exit_code == 1) << ended.out;
  const auto json = nlohmann::json::parse(ended.out);
  EXPECT_GT(json["changes"], 0);
  EXPECT_EQ(json["unseen"].get<bool>() ? 0 : 1, ended.exit_code);
  for (const char* key : {"changed", "others"}) EXPECT_LE(json[key]["p99_px"], json[key]["max_px"]) << key;
  EXPECT_LE(json["overlap_over_size"]["ground"]["p99"], json["overlap_over_size"]["ground"]["max"]);
  EXPECT_TRUE(json["energy"].contains("gained_j"));
  EXPECT_EQ(run("bench transitions " + name("none.yaml")).exit_code, 3);
}

// A ball that flies up, so that the scene's energy falls by nothing but rounding, and is full all the time:
// no change, and no figure of one.
TEST_F(TransitionsCommand, OfChangesThatThereAreNoneThereAreNoFigures) {
  std::ofstream(at("scene.yaml")) << R"(version: 1
step: {dt_s: 0.01, steps: 3, gravity_m_per_s2: [0, 0, 1]}
shapes: {ball: {sphere_m: 0.1}}
bodies: [{shape: ball, position_m: [0, 0, 1], velocity_m_per_s: [0, 0, 1], level: full}]
viewpoints: [{position_m: [0, -5, 1]}]
)";
  const auto ended = run("bench transitions " + name("scene.yaml") + " --json --from-s 1");
  EXPECT_EQ(ended.exit_code, 0) << ended.out;
  const auto json = nlohmann::json::parse(ended.out);
  EXPECT_EQ(json["changed"]["moves"], 0);
  for (const char* figure : {"p50_px", "p99_px", "max_px", "within_pixel"})
    EXPECT_TRUE(json["changed"][figure].is_null() && json["others"][figure].is_null()) << figure;
  for (const char* figure : {"p50", "p99", "max"})
    EXPECT_TRUE(json["overlap_over_size"]["bodies"][figure].is_null()) << figure;
}

TEST(TransitionFigures, ASceneThatGainsEnergyByItselfHasNoChangeToBlame) {
  TransitionFigures none;
  none.scene_j = -1e-12;
  EXPECT_TRUE(is_unseen(none));
  none.gained_j = 1e-15;
  EXPECT_FALSE(is_unseen(none));
}

}  // namespace
}  // namespace lodestone::transitions_test
