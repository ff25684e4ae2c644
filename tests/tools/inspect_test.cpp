#include <nlohmann/json.hpp>

#include "tests/tools/cli_fixture.h"
#include "tools/height_plot.h"

namespace lodestone {
namespace {

using testing::Ended;

class Inspect : public testing::CliTest {
 protected:
  void SetUp() override {
    const Ended ended =
        run("sign box:0.2,0.3,0.4 --cell-trials 2 --height-trials 20 --settling-trials 12 --clips 3 "
            "--no-cache -o " +
            name("box.sig"));
    ASSERT_EQ(ended.exit_code, 0) << ended.out;
  }
};

TEST_F(Inspect, JsonSaysWhatTheFileIsMadeOf) {
  const Ended ended = run("inspect --json " + name("box.sig"));
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  const auto json = nlohmann::json::parse(ended.out);
  std::size_t bytes = 0;
  for (const auto& section : json["sections"]) bytes += section["bytes"].get<std::size_t>();
  EXPECT_EQ(bytes, std::filesystem::file_size(at("box.sig")));
  EXPECT_EQ(json["bytes"], bytes);
  EXPECT_EQ(json["mesh"]["faces"], 12);
  EXPECT_EQ(json["mesh"]["bytes"], 12 * (8 + 12));
  EXPECT_EQ(json["seven_spheres_bytes"], 112);
  EXPECT_EQ(json["collision_heights"]["mean"].size(), 16U);
  EXPECT_NE(json["versions"].get<std::string>().find("ode "), std::string::npos);
  for (const char* key :
       {"tables", "rest_poses", "held_out_ks", "restitution", "friction", "clips", "shape_hash"})
    EXPECT_TRUE(json.contains(key)) << key;
  double kept = 0.0;
  for (const auto& pose : json["rest_poses"]) kept += pose["frequency"].get<double>();
  EXPECT_NEAR(json["settled_fraction"], kept, 1e-9);
  EXPECT_GT(kept, 0.8);
}

TEST_F(Inspect, OnePageShowsEverything) {
  const Ended ended = run("inspect " + name("box.sig"));
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  for (const char* part : {"box:0.2,0.3,0.4", "versions", "valid for", "held-out KS", "std. error", "energy",
                           "rest pose", "collision height over R", "settling clips", "seven spheres",
                           "mesh of 8 vertices and 12 faces", "support map"})
    EXPECT_NE(ended.out.find(part), std::string::npos) << part << "\n" << ended.out;
}

TEST_F(Inspect, DoesNotWriteOverWhatItReads) {
  const std::string before = testing::bytes_of(at("box.sig"));
  const Ended ended = run("inspect " + name("box.sig") + " --svg " + name("box.sig"));
  EXPECT_EQ(ended.exit_code, 3);
  EXPECT_NE(ended.out.find("box.sig: found the file that FILE reads, expected another one for --svg"),
            std::string::npos)
      << ended.out;
  EXPECT_EQ(testing::bytes_of(at("box.sig")), before);
}

TEST_F(Inspect, DrawsTheHeightCurve) {
  ASSERT_EQ(run("inspect " + name("box.sig") + " --svg " + name("height.svg")).exit_code, 0);
  const std::string svg = testing::bytes_of(at("height.svg"));
  EXPECT_EQ(svg.substr(0, 4), "<svg");
  EXPECT_NE(svg.find("<polyline"), std::string::npos);
  EXPECT_NE(svg.find("</svg>"), std::string::npos);
}

TEST_F(Inspect, DamageIsBadInput) {
  std::ofstream(at("half.sig"), std::ios::binary) << testing::bytes_of(at("box.sig")).substr(0, 5000);
  const Ended ended = run("inspect " + name("half.sig"));
  EXPECT_EQ(ended.exit_code, 3);
  EXPECT_NE(ended.out.find("half.sig: found 5000 bytes, expected"), std::string::npos) << ended.out;
}

TEST(HeightPlot, RisesFromLeftToRightWithTheHeights) {
  CollisionHeights heights;
  for (int i = 0; i < 16; ++i)
    heights.mean.push_back(0.5f + 0.02f * float(i)), heights.deviation.push_back(0.0f);
  const std::string plot = text_plot(heights);
  std::size_t last = std::string::npos;  // column of the lowest star is the first
  std::size_t begin = plot.find('\n') + 1;
  for (std::size_t end; (end = plot.find('\n', begin)) != std::string::npos; begin = end + 1) {
    const std::size_t star = plot.substr(begin, end - begin).find('*');
    if (star == std::string::npos) continue;
    EXPECT_LT(star, last) << plot;
    last = star;
  }
  EXPECT_EQ(last, 8U) << plot;
}

}  // namespace
}  // namespace lodestone
