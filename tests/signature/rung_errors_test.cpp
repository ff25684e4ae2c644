#include "signature/rung_errors.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/temporary_folder.h"

namespace lodestone {
namespace {

class RungErrorsFile : public ::testing::Test {
 protected:
  std::filesystem::path file() const { return folder_.at("shape.sig.errors"); }
  std::string bytes() const { return testing::bytes_of(file()); }
  void write(const std::string& content) const { std::ofstream(file(), std::ios::binary) << content; }

 private:
  const testing::TemporaryFolder folder_;
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
