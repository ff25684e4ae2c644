#include "reference/error.h"

#include <gtest/gtest.h>

#include "tests/message_of.h"

namespace lodestone {
namespace {

TEST(Errors, AMessageSaysWhereWhatWasFoundAndWhatIsExpected) {
  EXPECT_EQ(testing::message_of([] { throw_input_error("scene.yaml:3: mass", "-1 kg", "more than 0"); }),
            "scene.yaml:3: mass: found -1 kg, expected more than 0");
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
