#include "reference/error.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

#include "tests/message_of.h"

namespace lodestone {
namespace {

TEST(Errors, AMessageSaysWhereWhatWasFoundAndWhatIsExpected) {
  EXPECT_EQ(testing::message_of([] { throw_input_error("scene.yaml:3: mass", "-1 kg", "more than 0"); }),
            "scene.yaml:3: mass: found -1 kg, expected more than 0");
}

// The words between the quotes of what is given to the InputError whose bracket ends just before `at`.
std::string words_given(const std::string& source, std::size_t at) {
  std::string words;
  for (int depth = 1; depth > 0 && at < source.size(); ++at) {
    depth += int(source[at] == '(') - int(source[at] == ')');
    if (source[at] != '"') continue;
    for (++at; source[at] != '"'; ++at) {
      if (source[at] == '\\') ++at;
      words += source[at];
    }
    words += ' ';
  }
  return words;
}

// Where there are words, and not another message alone or with its place.
TEST(Errors, EveryMessageOfTheSourcesSaysSo) {
  namespace fs = std::filesystem;
  constexpr std::string_view kThrown = "InputError(";
  int messages = 0;
  for (const char* const room : {"reference", "signature", "lod", "scenes", "tools"})
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(LODESTONE_SOURCE_DIR) / room)) {
      if (entry.path().extension() != ".h" && entry.path().extension() != ".cpp") continue;
      std::ifstream file(entry.path());
      const std::string source{std::istreambuf_iterator<char>(file), {}};
      for (std::size_t at = source.find(kThrown); at != std::string::npos; at = source.find(kThrown, at)) {
        at += kThrown.size();
        const std::string words = words_given(source, at);
        if (words.find_first_not_of("{}: ") == std::string::npos) continue;
        ++messages;
        const std::size_t expected = words.find("expected ");
        EXPECT_TRUE(expected != std::string::npos && words.find("found ") < expected)
            << entry.path() << ": " << words;
      }
    }
  EXPECT_GT(messages, 70);
}

struct Bug {
  std::string message;
};

// The handler throws, as it may: nothing aborts then.
TEST(Errors, AnAssertionTellsItsHandlerPlaceContractAndValues) {
  set_assertion_handler([](std::string_view message) { throw Bug{std::string(message)}; });
  check_that(true, "holds");
  int line = 0;
  try {
    line = __LINE__ + 1;
    check_that(false, "one is two", "1 2");
    ADD_FAILURE();
  } catch (const Bug& bug) {
    EXPECT_NE(bug.message.find("error_test.cpp:" + std::to_string(line) + ": "), std::string::npos)
        << bug.message;
    EXPECT_TRUE(bug.message.ends_with("contract broken: one is two 1 2")) << bug.message;
  }
  set_assertion_handler({});
}

TEST(ErrorsDeathTest, WithoutAHandlerABugAborts) {
  ::testing::GTEST_FLAG(death_test_style) = "threadsafe";
  EXPECT_DEATH(check_that(false, "one is two"), "contract broken: one is two");
}

TEST(ErrorsDeathTest, AHandlerThatReturnsDoesNotSaveTheProgram) {
  ::testing::GTEST_FLAG(death_test_style) = "threadsafe";
  EXPECT_DEATH(
      {
        set_assertion_handler([](std::string_view) {});
        check_that(false, "one is two");
      },
      "one is two");
}

}  // namespace
}  // namespace lodestone
