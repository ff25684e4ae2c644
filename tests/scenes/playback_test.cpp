#include "scenes/playback.h"

#include <zlib.h>

#include <fstream>

#include "scenes/runner.h"
#include "tests/scenes/scene_fixture.h"

namespace lodestone::playback_test {
namespace {

// Two of three bodies full, which need no signature.
const char* const kFalling = R"(version: 1
step: {dt_s: 0.01, steps: 40, full_substeps: 2}
shapes: {ball: {sphere_m: 0.1}, crate: {box_m: [0.2, 0.2, 0.2]}}
ground: [{plane: {normal: [0, 0, 1], offset_m: 0}}, {box: {sides_m: [1, 1, 0.1], position_m: [5, 0, 0]}}]
bodies:
  - {shape: ball, position_m: [0, 0, 0.5], level: full, name: ball}
  - {shape: crate, position_m: [3, 0, 0.5], velocity_m_per_s: [1, 0, 0], angular_velocity_rad_per_s: [9, 2, 1], level: full}
output: {every_n_steps: 2}
)";

class SavedPlayback : public SceneFixture {
 protected:
  RunResult run() { return run_scene(load(kFalling), {.out = folder() / "out"}); }
  std::filesystem::path file() const { return folder() / "out/run.play"; }
  std::string error_of_loading() const {
    return testing::message_of([&] { load_playback(file()); });
  }
};

std::vector<std::uint8_t> inflated(const Playback& playback, const char* name) {
  const auto& place = playback.header["blobs"][name];
  std::vector<std::uint8_t> raw(place["raw_bytes"].get<std::size_t>());
  uLongf size = raw.size();
  EXPECT_EQ(
      uncompress(raw.data(), &size,
                 reinterpret_cast<const Bytef*>(playback.blobs.data()) + place["offset"].get<std::size_t>(),
                 place["bytes"].get<uLong>()),
      Z_OK);
  return raw;
}

TEST_F(SavedPlayback, HoldsEveryFrameOfEveryBody) {
  const RunResult result = run();
  ASSERT_EQ(result.playback, file());
  const Playback playback = load_playback(file());
  const auto& header = playback.header;
  EXPECT_EQ(header["bodies"], 2);
  EXPECT_EQ(header["times_s"].size(), 21u);
  EXPECT_EQ(header["step_ms"].size(), 40u);
  EXPECT_EQ(header["label"], "s: as the scene says");
  EXPECT_EQ(header["names"]["0"], "ball");
  EXPECT_EQ(header["shapes"].size(), 2u);
  EXPECT_EQ(header["ground"].size(), 2u);
  EXPECT_EQ(header["rules"].size(), std::size_t(Rule::paused) + 1);
  // Positions add up, frame after frame, to where the crate is at the end.
  const std::vector<std::uint8_t> raw = inflated(playback, "poses");
  ASSERT_EQ(raw.size(), 21u * 20 * 2);
  std::int32_t last = 0, before = 0;
  for (std::size_t frame = 0; frame < 21; ++frame) {
    std::uint32_t difference = 0;
    for (std::size_t byte = 0; byte < 4; ++byte)
      difference |= std::uint32_t(raw[frame * 40 + 2 * byte + 1]) << (8 * byte);  // x of the second body
    const auto now = std::int32_t(difference) + (frame == 0 ? 0 : frame == 1 ? last : 2 * last - before);
    before = last, last = now;
  }
  EXPECT_NEAR(last * header["unit_m"].get<double>(), result.states[1].position.x(),
              header["unit_m"].get<double>());
}

// Places are kept in parts of the smallest body: what was too far for that was shown where it never was.
TEST_F(SavedPlayback, FarFromATinyBodyNothingIsElsewhere) {
  std::string text = kFalling;
  text.replace(text.find("sphere_m: 0.1"), 13, "sphere_m: 0.001");
  text.replace(text.find("position_m: [3, 0, 0.5]"), 23, "position_m: [9000, 0, 0.5]");
  run_scene(load(text), {.out = folder() / "out"});
  const double unit_m = load_playback(file()).header["unit_m"].get<double>();
  EXPECT_GT(2e9 * unit_m, 9000.0);
  EXPECT_LT(unit_m, 1e-5);
}

TEST_F(SavedPlayback, SceneWithoutViewpointIsFramed) {
  run();
  const auto header = load_playback(file()).header;
  EXPECT_EQ(header["has_viewpoint"], false);
  ASSERT_EQ(header["viewpoints"].size(), 1u);
  EXPECT_GT(header["viewpoints"][0]["position_m"][2].get<double>(), 0.5);
}

TEST_F(SavedPlayback, WhatIsNoneIsRefused) {
  run();
  std::filesystem::resize_file(file(), std::filesystem::file_size(file()) - 9);
  EXPECT_NE(error_of_loading().find("found a playback file cut short"), std::string::npos)
      << error_of_loading();
  std::ofstream(file()) << "something else";
  EXPECT_NE(
      error_of_loading().find("found no playback file, expected what `lodestone run SCENE --out DIR` writes"),
      std::string::npos)
      << error_of_loading();
  std::filesystem::remove(file());
  EXPECT_NE(error_of_loading(), "no error");
}

// Of the same length, but with words where numbers are expected.
TEST_F(SavedPlayback, ADamagedHeadIsRefused) {
  for (const auto& [from, to] :
       {std::pair("\"offset\":", "\"offsat\":"), std::pair("\"label\":", "\"labol\":"),
        std::pair("\"blobs\":{", "\"blobs\":[")}) {
    run();
    std::ifstream in(file(), std::ios::binary);
    std::string bytes((std::istreambuf_iterator<char>(in)), {});
    ASSERT_NE(bytes.find(from), std::string::npos) << from;
    bytes.replace(bytes.find(from), std::string(from).size(), to);
    std::ofstream(file(), std::ios::binary) << bytes;
    EXPECT_NE(error_of_loading().find("a damaged playback file"), std::string::npos) << error_of_loading();
  }
}

TEST_F(SavedPlayback, EndsWithTheLastStep) {
  std::string text = kFalling;
  text.replace(text.find("every_n_steps: 2"), 16, "every_n_steps: 7");
  const RunResult result = run_scene(load(text), {.level = LevelChoice::full, .out = folder() / "out"});
  const auto times = load_playback(file()).header["times_s"];
  ASSERT_EQ(times.size(), 7u);  // 0, 7, … 35, 40
  EXPECT_EQ(times[6], 0.4);
  EXPECT_EQ(result.steps, 40);
}

TEST_F(SavedPlayback, TwoFuturesAreOneUntilTheFork) {
  const Scene scene = load(R"(version: 1
step: {dt_s: 0.01, steps: 60, full_substeps: 2}
shapes: {crate: {box_m: [0.2, 0.3, 0.2]}}
ground: [{plane: {normal: [0, 0, 1], offset_m: 0}}]
bodies: [{shape: crate, position_m: [0, 0, 0.4], angular_velocity_rad_per_s: [3, 1, 0]}, {shape: crate, position_m: [1, 0, 0.6]}]
viewpoints: [{position_m: [0, -2, 1]}]
lod: {policy: distance, full_within_m: 100}
output: {every_n_steps: 1}
)");
  const RunResult plain = run_scene(scene),
                  same = run_scene(scene, {.level = LevelChoice::full, .fork_step = 10}),
                  other = run_scene(
                      scene, {.level = LevelChoice::support, .fork_step = 10, .out = folder() / "out"});
  ASSERT_TRUE(same.fork && other.fork);
  EXPECT_EQ(same.state_hash, plain.state_hash);
  EXPECT_EQ(other.state_hash, plain.state_hash);  // the first future knows nothing of the second
  EXPECT_EQ(same.fork->mean_distance_m.size(), 50u);
  EXPECT_EQ(same.fork->mean_distance_m.back(), 0.0);
  EXPECT_EQ(other.fork->step, 10);
  EXPECT_LT(other.fork->mean_distance_m.front(), 1e-3);
  EXPECT_GT(other.fork->mean_distance_m.back(), 0.0);
  EXPECT_EQ(other.fork->result.last().support, 2);
  EXPECT_EQ(load_playback(folder() / "out/fork.play").header["times_s"][0], 0.1);
  EXPECT_EQ(load_playback(folder() / "out/fork.play").header["label"], "s: level support");
  std::filesystem::remove(folder() / "out/fork.play");
  std::filesystem::create_directories(folder() / "out/fork.play/in the way");
  const RunResult lost =
      run_scene(scene, {.level = LevelChoice::support, .fork_step = 10, .out = folder() / "out"});
  EXPECT_NE(lost.write_error.find("fork.play: found "), std::string::npos) << lost.write_error;
  EXPECT_THROW(run_scene(scene, {.level = LevelChoice::full, .fork_step = 60}), InputError);
  EXPECT_THROW(run_scene(scene, {.fork_step = 10}), InputError);
}

TEST_F(SavedPlayback, TheSecondFutureKeepsTheLevelsOfTheScene) {
  const Scene scene = load(R"(version: 1
step: {dt_s: 0.01, steps: 20, full_substeps: 2}
shapes: {crate: {box_m: [0.2, 0.3, 0.2]}}
ground: [{plane: {normal: [0, 0, 1], offset_m: 0}}]
bodies: [{shape: crate, position_m: [0, 0, 0.4], level: support}, {shape: crate, position_m: [1, 0, 0.6]}]
viewpoints: [{position_m: [0, -2, 1]}]
lod: {policy: distance, full_within_m: 0}
)");
  const RunResult run = run_scene(scene, {.full_within_m = 100.0, .fork_step = 10});
  ASSERT_TRUE(run.fork);
  EXPECT_EQ(run.fork->result.last().full, 1);
  EXPECT_EQ(run.fork->result.last().support, 1);
}

}  // namespace
}  // namespace lodestone::playback_test
