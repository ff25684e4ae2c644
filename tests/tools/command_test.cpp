#include "tools/command.h"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "tools/commands.h"

namespace lodestone {
namespace {

enum class Fruit { apple, pear };

struct Arguments {
  int count = 3;
  std::vector<double> sizes = {1.0};
  Fruit fruit = Fruit::apple;
  bool ripe = false;
};

// `pick [--count] [--sizes] [--fruit] [--ripe]`, which ends as `end` says.
class CommandTest : public ::testing::Test {
 protected:
  CommandTest() {
    auto [command, arguments] =
        Command(program_, exit_code_).add<Arguments>("pick", "some fruit", [this](Arguments& a) {
          picked_ = a;
          return end_;
        });
    command.add_option("--count", arguments.count, "how many").within(1, 9);
    command.add_option("--sizes", arguments.sizes, "of them").several().within(0.0, 2.0);
    command.add_choice<Fruit>("--fruit", arguments.fruit, {{"apple", Fruit::apple}, {"pear", Fruit::pear}},
                              "which");
    command.add_flag("--ripe", arguments.ripe, "or not");
  }

  void parse(const std::string& line) { program_.parse(line); }

  CLI::App program_;
  ExitCode exit_code_ = ExitCode::usage, end_ = ExitCode::done;
  std::optional<Arguments> picked_;
};

TEST_F(CommandTest, RunsWithDefaultsWhereNothingIsSaid) {
  parse("pick");
  ASSERT_TRUE(picked_);
  EXPECT_EQ(picked_->count, 3);
  EXPECT_EQ(picked_->fruit, Fruit::apple);
  EXPECT_EQ(exit_code_, ExitCode::done);
}

TEST_F(CommandTest, ReadsWhatIsSaid) {
  parse("pick --count 5 --sizes 0.5,1.5 --fruit pear --ripe");
  EXPECT_EQ(picked_->count, 5);
  EXPECT_EQ(picked_->sizes, (std::vector<double>{0.5, 1.5}));
  EXPECT_EQ(picked_->fruit, Fruit::pear);
  EXPECT_TRUE(picked_->ripe);
}

TEST_F(CommandTest, WholeNumbersHaveBaseTen) {
  check_values(program_);
  parse("pick --count +5");
  EXPECT_EQ(picked_->count, 5);
  EXPECT_THROW(parse("pick --count 05"), CLI::ValidationError);
  EXPECT_THROW(parse("pick --count 0x5"), CLI::ValidationError);
}

TEST_F(CommandTest, EndsAsItSays) {
  end_ = ExitCode::check_failed;
  parse("pick");
  EXPECT_EQ(exit_code_, ExitCode::check_failed);
}

TEST_F(CommandTest, WhatIsOutOfRangeOrUnknownDoesNotRun) {
  for (const char* line : {"pick --count 10", "pick --sizes 1,3", "pick --fruit plum", "pick --fruit 1"})
    EXPECT_THROW(parse(line), CLI::ValidationError) << line;
  EXPECT_FALSE(picked_);
}

TEST_F(CommandTest, DefaultsAreShown) {
  const std::string help = program_.get_subcommand("pick")->help();
  EXPECT_NE(help.find("=3"), std::string::npos) << help;
  EXPECT_NE(help.find("{apple,pear}"), std::string::npos) << help;
}

// What holds for the numbers of every command.

struct OptionPath {
  std::vector<std::string> words;  // of the command line, up to the option
  std::string type;
};

void collect(CLI::App& command, const std::vector<std::string>& words, std::vector<OptionPath>& options) {
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_positional()) continue;
    std::vector<std::string> path = words;
    path.push_back(option->get_name(false, false));
    options.push_back({path, option->get_type_name()});
  }
  for (CLI::App* inner : command.get_subcommands([](CLI::App*) { return true; })) {
    std::vector<std::string> path = words;
    path.push_back(inner->get_name());
    collect(*inner, path, options);
  }
}

class ArgumentChecks : public ::testing::Test {
 protected:
  ArgumentChecks() {
    Command commands(program_, exit_code_);
    add_commands(commands);
    check_values(program_);
  }

  // Those of every command whose type begins with `type`.
  std::vector<OptionPath> options_of(const std::string& type) {
    std::vector<OptionPath> options;
    collect(program_, {}, options);
    std::erase_if(options, [&](const OptionPath& option) { return !option.type.starts_with(type); });
    return options;
  }

  void expect_refused(const OptionPath& option, const std::string& value, const std::string& expected) {
    std::vector<std::string> words = option.words;
    words.back() += "=" + value;  // so that −1 is no option
    std::ranges::reverse(words);  // as CLI11 takes them
    std::string error = "none";
    try {
      program_.parse(words);
    } catch (const CLI::ValidationError& found) {
      error = found.what();
    }
    EXPECT_TRUE(error.starts_with(option.words.back() + ": found '" + value + "', expected " + expected))
        << option.words[0] << ' ' << value << ": " << error;
  }

  // What is wrong with the lists of a command line.
  std::string fault_of(std::vector<std::string> words) {
    words.insert(words.begin(), "lodestone");
    std::vector<const char*> pointers;
    for (const std::string& word : words) pointers.push_back(word.c_str());
    try {
      check_lists(program_, int(pointers.size()), pointers.data());
    } catch (const CLI::ParseError& found) {
      return found.what();
    }
    return "none";
  }

 private:
  CLI::App program_;
  ExitCode exit_code_{};
};

TEST_F(ArgumentChecks, NoRealOptionOfAnyCommandTakesWhatIsNoNumber) {
  const auto options = options_of("FLOAT");
  ASSERT_GT(options.size(), 20U);
  for (const OptionPath& option : options)
    for (const char* value : {"nan", "-nan", "inf", "-inf", "1e999", "1x", "many"})
      expect_refused(option, value, "");
}

TEST_F(ArgumentChecks, NoCountIsNegative) {
  const auto options = options_of("UINT");
  ASSERT_GT(options.size(), 5U);
  for (const OptionPath& option : options)
    for (const char* value : {"-1", "1.5", "99999999999999999999", "010", "0x10"})
      expect_refused(option, value, "a whole number from 0 on");
}

TEST_F(ArgumentChecks, NoIntegerIsCut) {
  const auto options = options_of("INT");
  ASSERT_GT(options.size(), 20U);
  for (const OptionPath& option : options)
    for (const char* value : {"1.5", "nan", "99999999999999999999", "1e3", "010", "-010", "0x10"})
      expect_refused(option, value, "a whole number");
}

TEST_F(ArgumentChecks, RangesAreSaidAsFoundAndExpected) {
  expect_refused({{"compare", "drop", "--slope-deg"}, ""}, "90", "a number in [0 - 80]");
  expect_refused({{"compare", "drop", "--restitution"}, ""}, "2", "a number in [0 - 1]");
  expect_refused({{"sign", "--density"}, ""}, "-1", "a number above 0");
  expect_refused({{"run", "--steps"}, ""}, "0", "a whole number in [1 - 100000000]");
  expect_refused({{"run", "--level"}, ""}, "fast", "one of {auto,");
  expect_refused({{"run", "--dt"}, ""}, "nan", "seconds from 1e-9 to 0.1");
  expect_refused({{"run", "--budget-ms"}, ""}, "nan", "");
}

// CLI11 passes over them.
TEST_F(ArgumentChecks, NoItemOfAListIsEmpty) {
  for (const char* list : {"0.01,,0.02", ",0.01", "0.01,"}) {
    const std::string expected = "--dt: found '', expected seconds from 1e-9 to 0.1";
    EXPECT_TRUE(fault_of({"compare", "drop", "box:1,1,1", "--dt", list}).starts_with(expected)) << list;
    EXPECT_TRUE(fault_of({"compare", "drop", "box:1,1,1", std::string("--dt=") + list}).starts_with(expected))
        << list;
  }
  EXPECT_EQ(fault_of({"compare", "drop", "box:1,1,1", "--dt", "0.01,0.02"}), "none");
  EXPECT_TRUE(
      fault_of({"compare", "drop", "--methods", "full_1,", "box:1,1,1"}).starts_with("--methods: found ''"));
}

TEST(Program, AValueThatIsNoneIsUsage) {
  for (const char* argument : {"--speed-scale=nan", "--slope-deg=inf", "--seed=-1"}) {
    std::array<std::string, 5> words = {"lodestone", "compare", "drop", "box:1,1,1", argument};
    std::array<char*, 5> arguments;
    std::ranges::transform(words, arguments.begin(), [](std::string& word) { return word.data(); });
    ::testing::internal::CaptureStderr();
    EXPECT_EQ(run_lodestone(int(arguments.size()), arguments.data()), ExitCode::usage) << argument;
    EXPECT_TRUE(::testing::internal::GetCapturedStderr().starts_with("lodestone: --")) << argument;
  }
}

}  // namespace
}  // namespace lodestone
