// What `sign` says of a mesh that had to be mended.
#include <array>
#include <nlohmann/json.hpp>

#include "tests/tools/cli_fixture.h"

namespace lodestone {
namespace {

const std::string kFewTrials =
    " --size 0.3 --cell-trials 2 --height-trials 20 --settling-trials 7 --clips 3 --threads 1 --no-cache ";

// Faces of a cube of side `side` (m) about the origin, whose first corner is the `first`-th of the file.
std::string cube(double side, int first) {
  std::string text;
  for (int i = 0; i < 8; ++i)
    for (const int axis : {1, 2, 4})
      text += (axis == 1 ? "v " : " ") + std::to_string(i & axis ? 0.5 * side : -0.5 * side) +
              (axis == 4 ? "\n" : "");
  for (const auto& [a, b, c] : std::array<std::array<int, 3>, 12>{{{0, 2, 1},
                                                                   {1, 2, 3},
                                                                   {4, 5, 6},
                                                                   {5, 7, 6},
                                                                   {0, 1, 4},
                                                                   {1, 5, 4},
                                                                   {2, 6, 3},
                                                                   {3, 6, 7},
                                                                   {0, 4, 2},
                                                                   {2, 4, 6},
                                                                   {1, 3, 5},
                                                                   {3, 7, 5}}})
    text += "f " + std::to_string(first + a) + " " + std::to_string(first + b) + " " +
            std::to_string(first + c) + "\n";
  return text;
}

using SignRepairs = testing::CliTest;

TEST_F(SignRepairs, AreInTheTextAndTheJson) {
  std::ofstream(at("mended.obj")) << cube(1.0, 1) << "f 1 3 2\n"  // twice
                                  << cube(0.4, 9);                // a cavity, whose faces are turned
  const testing::Ended json = run("sign " + name("mended.obj") + kFewTrials + "--json");
  ASSERT_EQ(json.exit_code, 0) << json.out;
  const auto mesh = nlohmann::json::parse(json.out)["mesh"];
  EXPECT_EQ(mesh["components"], 2);
  EXPECT_EQ(mesh["duplicate_faces_dropped"], 1);
  EXPECT_EQ(mesh["faces_flipped"], 12);
  EXPECT_EQ(mesh["nested_parts"], 1);
  EXPECT_EQ(mesh["overlapping_parts"], 0);
  const testing::Ended text = run("sign " + name("mended.obj") + kFewTrials);
  EXPECT_NE(text.out.find("mesh         1 duplicate faces dropped, 12 faces flipped, 1 nested parts\n"),
            text.out.npos)
      << text.out;
}

TEST_F(SignRepairs, AreNoneOfASoundMeshAndOfASolid) {
  std::ofstream(at("sound.obj")) << cube(1.0, 1);
  const testing::Ended sound = run("sign " + name("sound.obj") + kFewTrials);
  ASSERT_EQ(sound.exit_code, 0) << sound.out;
  EXPECT_EQ(sound.out.find("\nmesh "), sound.out.npos) << sound.out;
  const testing::Ended solid =
      run("sign box:0.2,0.3,0.4 --cell-trials 2 --height-trials 20 --settling-trials 7 --clips 3 --threads 1 "
          "--no-cache --json");
  EXPECT_FALSE(nlohmann::json::parse(solid.out).contains("mesh"));
}

}  // namespace
}  // namespace lodestone
