// The example game on a virtual display, with OpenGL in software.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <set>
#include <vector>

#include "tests/tools/cli_fixture.h"

namespace lodestone {
namespace {

using Color = std::array<int, 3>;  // red, green, blue, 0 … 255

struct Picture {
  int width = 0, height = 0;
  std::vector<Color> pixels;
};

// Uncompressed, 24 bits a pixel, as SDL_SaveBMP writes it; none of it where the file is anything else.
Picture load_picture(const std::filesystem::path& file) {
  const std::string bytes = testing::bytes_of(file);
  if (bytes.size() < 54 || !bytes.starts_with("BM")) return {};
  std::int32_t pixels = 0, width = 0, height = 0;
  std::int16_t bits = 0;
  std::memcpy(&pixels, &bytes[10], 4), std::memcpy(&width, &bytes[18], 4),
      std::memcpy(&height, &bytes[22], 4), std::memcpy(&bits, &bytes[28], 2);
  const std::size_t row = (std::size_t(width) * 3 + 3) / 4 * 4;
  if (bits != 24 || bytes.size() < std::size_t(pixels) + row * std::size_t(height)) return {};
  Picture picture{width, height, {}};
  const auto value = [&](std::size_t at) { return int(static_cast<unsigned char>(bytes[at])); };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t at = std::size_t(pixels) + row * std::size_t(y) + 3 * std::size_t(x);
      picture.pixels.push_back({value(at + 2), value(at + 1), value(at)});
    }
  return picture;
}

template <class Condition>
double share_of(const Picture& picture, Condition condition) {
  return double(std::ranges::count_if(picture.pixels, condition)) / double(picture.pixels.size());
}

struct Figures {
  int frames = 0, full = 0, support = 0, tables = 0, asleep = 0;
  double p50_ms = 0, p99_ms = 0;
};

class Game : public testing::CliTest {
 protected:
  void SetUp() override {
#ifndef LODESTONE_GAME
    GTEST_SKIP() << "built without SDL2 or OpenGL";
#endif
  }
#ifdef LODESTONE_GAME
  testing::Ended start(const std::string& how, const std::string& arguments) const {
    return testing::run_shell("XDG_CACHE_HOME=" + testing::quoted(at("cache").string()) + ' ' + how + ' ' +
                              testing::quoted(LODESTONE_GAME) + ' ' + arguments + " 2>&1");
  }
#else
  testing::Ended start(const std::string&, const std::string&) const { return {}; }
#endif
  testing::Ended play(const std::string& arguments) const {
    return start(
        "LIBGL_ALWAYS_SOFTWARE=1 xvfb-run -a -f " + name("xauthority") + " -s '-screen 0 1280x720x24'",
        arguments);
  }  // with a file of its own it has none to fail at removing
};

TEST_F(Game, RunsOnAVirtualDisplayAndShowsItsWorld) {
  const testing::Ended ended = play("--frames 120 --screenshot " + name("picture.bmp"));
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  Figures f;
  const auto line = ended.out.find("frames ");
  ASSERT_NE(line, std::string::npos) << ended.out;
  ASSERT_EQ(
      std::sscanf(&ended.out[line], "frames %d full %d support %d tables %d asleep %d p50_ms %lf p99_ms %lf",
                  &f.frames, &f.full, &f.support, &f.tables, &f.asleep, &f.p50_ms, &f.p99_ms),
      7);
  EXPECT_EQ(f.frames, 120);
  EXPECT_GE(f.full, 11) << "the parts of a ragdoll are always full";
  EXPECT_EQ(f.full + f.support + f.tables, 6 * 80 + 11 + 4)
      << "heaps, a ragdoll and the balls thrown; nothing fell out of the world";
  EXPECT_GT(f.p50_ms, 0.0);
  EXPECT_GE(f.p99_ms, f.p50_ms);

  const Picture picture = load_picture(at("picture.bmp"));
  ASSERT_EQ(picture.width, 1280);
  ASSERT_EQ(picture.height, 720);
  EXPECT_GT(std::set<Color>(picture.pixels.begin(), picture.pixels.end()).size(), 500U);
  EXPECT_GT(share_of(picture, [](const Color& c) { return c[2] > c[0] + 20 && c[2] > 180 && c[0] > 140; }),
            0.05)
      << "sky";
  EXPECT_GT(share_of(picture, [](const Color& c) { return c[0] > c[2] + 15 && c[0] < c[2] + 60; }), 0.15)
      << "ground";
  EXPECT_GT(share_of(picture, [](const Color& c) { return c[0] > c[2] + 110; }), 0.001)
      << "full bodies, orange";
  EXPECT_GT(share_of(picture, [](const Color& c) { return std::max(c[1], c[2]) > c[0] + 60; }), 0.005)
      << "bodies on the statistical rungs, light blue or, once their signatures are measured, green";
}

TEST_F(Game, SaysWhatItCannotDo) {
  EXPECT_EQ(play("--frames many").exit_code, 2);
  EXPECT_EQ(play("--screenshot picture.bmp").exit_code, 2) << "a picture of which frame?";
  const testing::Ended unwritten = play("--frames 1 --screenshot " + name("no such folder/picture.bmp"));
  EXPECT_EQ(unwritten.exit_code, 3);
  EXPECT_NE(unwritten.out.find("no such folder"), std::string::npos) << unwritten.out;
  const testing::Ended unseen = start("env -u DISPLAY -u WAYLAND_DISPLAY -u SDL_VIDEODRIVER", "--frames 1");
  EXPECT_EQ(unseen.exit_code, 3);
  EXPECT_NE(unseen.out.find("no display"), std::string::npos) << unseen.out;
}

TEST_F(Game, TellsHowItIsUsedWithoutADisplay) {
  const testing::Ended help = start("env -u DISPLAY -u WAYLAND_DISPLAY", "--help");
  EXPECT_EQ(help.exit_code, 0) << help.out;
  EXPECT_TRUE(help.out.starts_with("usage: lodestone_game")) << help.out;
  EXPECT_EQ(start("env -u DISPLAY -u WAYLAND_DISPLAY", "--frames 0").exit_code, 2);
}

}  // namespace
}  // namespace lodestone
