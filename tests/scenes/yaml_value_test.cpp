#include "scenes/yaml_value.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>

#include "reference/error.h"
#include "tests/message_of.h"

namespace lodestone {
namespace {

std::string error_of(const std::string& text, const YamlLimits& limits = {}) {
  return testing::message_of([&] { make_yaml(text, "s.yaml", limits); });
}

TEST(YamlValue, KeepsLinesAndOrder) {
  const YamlValue value = make_yaml("b: 1\na: [2, \"3\"]\n", "s.yaml");
  ASSERT_EQ(value.entries.size(), 2u);
  EXPECT_EQ(value.entries[0].key, "b");
  EXPECT_EQ(value.entries[1].line, 2);
  ASSERT_EQ(value.entries[1].value.items.size(), 2u);
  EXPECT_FALSE(value.entries[1].value.items[0].quoted);
  EXPECT_TRUE(value.entries[1].value.items[1].quoted);
}

TEST(YamlValue, ExpandsAliases) {
  const YamlValue value = make_yaml("a: &x [1, 2]\nb: *x\n", "s.yaml");
  EXPECT_EQ(value.entries[1].value.items.size(), 2u);
}

// A message that quotes one would end there.
// Names of a scene go into files that are UTF-8.
TEST(YamlValue, RefusesTextThatIsNoUtf8) {
  EXPECT_EQ(error_of("a: 1\nb: cr\xe2te\n"),
            "s.yaml:2: text: found bytes that are no character, expected UTF-8 without any");
  EXPECT_EQ(error_of("a: \xff\n"),
            "s.yaml:1: text: found bytes that are no character, expected UTF-8 without any");
  EXPECT_EQ(make_yaml("a: cr\xc3\xa2te\n", "s.yaml").entries.at(0).value.text, "cr\xc3\xa2te");
}

TEST(YamlValue, LinesMayEndInCarriageReturns) {
  for (const char* text : {"a: [1, 2]\r\nb: 3\r\n", "b: 3\r\na: [1, 2]\r"})
    EXPECT_EQ(make_yaml(text, "s.yaml").entries.size(), 2U) << text;
}

TEST(YamlValue, RefusesZeroBytes) {
  using namespace std::string_literals;
  EXPECT_EQ(error_of("a: 1\nb: x\0y\n"s), "s.yaml:2: text: found a zero byte, expected UTF-8 without any");
  EXPECT_EQ(error_of("a: 1\nb: \"\\0\"\n"), "s.yaml:2: text: found a zero byte, expected none");
  EXPECT_EQ(error_of("\"\\0\": 1\n"), "s.yaml:1: text: found a zero byte, expected none");
}

TEST(YamlValue, RefusesWhatYamlCppLetsPass) {
  EXPECT_EQ(error_of("a: 1\nb: 2\na: 3\n"),
            "s.yaml:3: a: found the key a second time, expected it once (first in line 1)");
  EXPECT_EQ(error_of("a: 1\n---\nb: 2\n").substr(0, 33), "s.yaml:2: document: found a secon");
  EXPECT_EQ(error_of("a: &x\n  b: *x\n").substr(0, 16), "s.yaml:2: alias:");
  EXPECT_EQ(error_of("a: &x [[*x]]\n").substr(0, 16), "s.yaml:1: alias:");
  EXPECT_EQ(error_of("a: !!binary 12\n").substr(0, 14), "s.yaml:1: tag:");
  EXPECT_EQ(error_of("? [1, 2]\n: 3\n").substr(0, 14), "s.yaml:1: key:");
  EXPECT_EQ(error_of("~: 3\n").substr(0, 14), "s.yaml:1: key:");
  EXPECT_EQ(error_of("").substr(0, 19), "s.yaml:1: document:");
  EXPECT_EQ(error_of("a: 1\nb: [1, 2\n").substr(0, 9), "s.yaml:3:");
  EXPECT_NE(error_of("a: 1\n b: 2\n").find("syntax: found"), std::string::npos);
  EXPECT_TRUE(
      error_of("a: 1\nb: [{c: [0, 0\n")
          .ends_with(":2: key: found no plain name at column 5, expected a name as key (is a bracket not "
                     "closed?)"))
      << error_of("a: 1\nb: [{c: [0, 0\n");
}

TEST(YamlValue, LimitsNesting) {
  const auto nested = [](int depth) {
    return std::string(std::size_t(depth), '[') + std::string(std::size_t(depth), ']');
  };
  EXPECT_EQ(error_of(nested(32)), "no error");
  EXPECT_EQ(error_of(nested(33)), "s.yaml:1: nesting: found more levels, expected at most 32");
  EXPECT_EQ(error_of(nested(100'000)).substr(0, 18), "s.yaml:1: nesting:");
  // Deep by way of aliases: each level holds the one before.
  std::string text = "a0: &a0 [1]\n";
  for (int i = 1; i < 40; ++i) text += fmt::format("a{0}: &a{0} [*a{1}]\n", i, i - 1);
  EXPECT_NE(error_of(text).find("nesting"), std::string::npos);
}

TEST(YamlValue, LimitsExpansion) {
  std::string text = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (int i = 1; i < 20; ++i) {
    text += fmt::format("a{0}: &a{0} [*a{1}", i, i - 1);
    for (int k = 1; k < 10; ++k) text += fmt::format(", *a{}", i - 1);
    text += "]\n";
  }
  EXPECT_NE(error_of(text).find("size: found more values"), std::string::npos);
  // Few, but long ones.
  std::string long_ones = "a: &a '" + std::string(1 << 20, 'x') + "'\nb: [*a";
  for (int i = 0; i < 70; ++i) long_ones += ", *a";
  EXPECT_NE(error_of(long_ones + "]\n").find("size: found more text by aliases"), std::string::npos);
}

TEST(YamlValue, RefusesWhatIsNoFile) {
  EXPECT_THROW(load_yaml("/nonexistent/scene.yaml"), InputError);
  EXPECT_THROW(load_yaml(::testing::TempDir()), InputError);
  EXPECT_THROW(load_yaml("/dev/zero"), InputError);
}

// Whatever is cut off or damaged, there is either a value or an InputError.
TEST(YamlValue, SurvivesTruncationAndDamage) {
  std::ifstream in(LODESTONE_SOURCE_DIR "/scenes/bunnies.yaml", std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  ASSERT_GT(text.size(), 100u);
  for (std::size_t length = 0; length <= text.size(); ++length) error_of(text.substr(0, length));
  for (std::size_t place = 0; place < text.size(); ++place)
    for (char c : {'\0', '\t', '{', ']', '*', '&', '"', '\xff', ':', '\n'}) {
      std::string damaged = text;
      damaged[place] = c;
      error_of(damaged);
    }
}

}  // namespace
}  // namespace lodestone
