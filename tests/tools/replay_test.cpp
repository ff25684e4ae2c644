// `lodestone run --record` and `lodestone replay`, as a user calls them.
#include <filesystem>
#include <fstream>

#include "tests/tools/cli_fixture.h"

namespace lodestone::testing {
namespace {

class ReplayTest : public CliTest {
 protected:
  ReplayTest() {
    std::ofstream(at("scene.yaml")) << R"(version: 1
step: {dt_s: 0.016667, seed: 7, steps: 60}
shapes: {crate: {box_m: [0.2, 0.3, 0.4]}}
ground: [{plane: {normal: [0, 0, 1], offset_m: 0}}]
bodies: [{shape: crate, scatter: {count: 20, box_m: [[-1, -1, 0.5], [1, 1, 2]], seed: 3}}]
viewpoints: [{position_m: [0, -2, 1], look_at_m: [0, 0, 0]}]
lod: {policy: distance, full_within_m: 2, support_within_m: 3}
)";
  }
};

TEST_F(ReplayTest, WhatWasRecordedIsDoneAgain) {
  const Ended recorded = run("run " + name("scene.yaml") + " --record " + name("run.rec"));
  ASSERT_EQ(recorded.exit_code, 0) << recorded.out;
  const Ended replayed = run("replay " + name("run.rec") + " " + name("scene.yaml") + " --threads 2");
  EXPECT_EQ(replayed.exit_code, 0) << replayed.out;
  EXPECT_NE(replayed.out.find("all 60 steps are as they were recorded"), std::string::npos) << replayed.out;
}

TEST_F(ReplayTest, OneThatBreaksOffSaysSo) {
  ASSERT_EQ(run("run " + name("scene.yaml") + " --record " + name("run.rec")).exit_code, 0);
  const auto file = at("run.rec");
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 5);
  const Ended replayed = run("replay " + name("run.rec") + " " + name("scene.yaml"));
  EXPECT_EQ(replayed.exit_code, 0) << replayed.out;
  EXPECT_NE(replayed.out.find("all 59 steps are as they were recorded; the recording breaks off"),
            std::string::npos)
      << replayed.out;
}

TEST_F(ReplayTest, WhatComesOutOtherwiseIsNamed) {
  ASSERT_EQ(run("run " + name("scene.yaml") + " --record " + name("run.rec")).exit_code, 0);
  const Ended replayed = run("replay " + name("run.rec") + " " + name("scene.yaml") + " --level support");
  EXPECT_EQ(replayed.exit_code, 0) << "bodies have the level that they were recorded with: " << replayed.out;
  const Ended other = run("replay " + name("run.rec") + " " + name("scene.yaml") + " --budget-work 1");
  EXPECT_EQ(other.exit_code, 1) << other.out;
  EXPECT_NE(other.out.find("(crate) is not as it was recorded"), std::string::npos) << other.out;
}

// With the file's name, which is the one that a user knows.
TEST_F(ReplayTest, WhatCannotBeReplayedIsNamedWithItsFile) {
  ASSERT_EQ(run("run " + name("scene.yaml") + " --record " + name("run.rec")).exit_code, 0);
  const auto says = [this](const std::string& file, const std::string& options, const std::string& text) {
    const Ended ended = run("replay " + name(file) + " " + name("scene.yaml") + options);
    EXPECT_EQ(ended.exit_code, 3);
    EXPECT_NE(ended.out.find(at(file).string() + ": found " + text), std::string::npos) << ended.out;
  };
  says("scene.yaml", "", "no LODEREC3 at its beginning, expected what ");
  says("run.rec", " --seed 8", "one of a manager with seed 7, expected one with seed 8");
  std::fstream file(at("run.rec"), std::ios::binary | std::ios::in | std::ios::out);
  file.seekp(500).put('\xff');
  file.close();
  says("run.rec", "", "damage in chunk 1, at byte 8, expected ");
}

}  // namespace
}  // namespace lodestone::testing
