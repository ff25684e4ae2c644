// A command with options of a test's own, parsed.
#pragma once

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <string>

#include "tools/command.h"

namespace lodestone::testing {

/// What `line` makes of an `Arguments` to which `add(command, arguments)` adds options; a CLI::Error where it
/// is refused.
template <class Arguments>
Arguments parse(const std::string& line, const auto& add) {
  CLI::App program;
  ExitCode exit_code = ExitCode::usage;
  Arguments parsed;
  auto [command, arguments] =
      Command(program, exit_code).add<Arguments>("do", "it", [&](Arguments& given) { parsed = given; });
  add(command, arguments);
  check_values(program);
  program.parse("do " + line);
  EXPECT_EQ(exit_code, ExitCode::done);
  return parsed;
}

/// What is said of a line that is refused.
template <class Arguments>
std::string refusal(const std::string& line, const auto& add) {
  try {
    parse<Arguments>(line, add);
  } catch (const CLI::Error& fault) {
    return fault.what();
  }
  return "no error";
}

}  // namespace lodestone::testing
