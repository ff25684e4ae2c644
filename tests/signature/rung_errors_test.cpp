#include "signature/rung_errors.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

namespace lodestone {
namespace {

class RungErrorsFile : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path file() const { return folder_ / "shape.sig.errors"; }
  std::string bytes() const {
    std::ifstream stream(file(), std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  void write(const std::string& content) const { std::ofstream(file(), std::ios::binary) << content; }

 private:
  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("lodestone-errors-" + std::to_string(::getpid()));
};

TEST_F(RungErrorsFile, ComesBackAsItWas) {
  const RungErrors errors{.tables = {0.5, 0.9}, .support = {0.08, 0.3}, .full = {0.1, 0.2}, .drops = 300};
  save_rung_errors(errors, file());
  EXPECT_EQ(load_rung_errors(file()), errors);
}

TEST_F(RungErrorsFile, NoneWhereThereIsNone) { EXPECT_FALSE(load_rung_errors(file())); }

TEST_F(RungErrorsFile, DamageAtAnyByteIsFound) {
  save_rung_errors({.drops = 7}, file());
  const std::string sound = bytes();
  for (std::size_t i = 0; i < sound.size(); ++i) {
    std::string damaged = sound;
    damaged[i] = char(damaged[i] ^ 0x10);
    write(damaged);
    EXPECT_FALSE(load_rung_errors(file())) << i;
    write(sound.substr(0, i));
    EXPECT_FALSE(load_rung_errors(file())) << i;
  }
  write(sound + "x");
  EXPECT_FALSE(load_rung_errors(file()));
}

}  // namespace
}  // namespace lodestone
