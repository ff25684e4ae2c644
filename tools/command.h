// A command of `lodestone`: its options, each read into a value of the command's own, and what it does once
// it is chosen. CLI11 is behind this header: its own cost each file that includes them six seconds of
// compiling.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace lodestone {

/// What scripts can rely on. `usage`: the command line is wrong, a name or a value in it. `bad_input`: what
/// it names cannot be used: a shape, or a file that cannot be read, is wrong, or cannot be written (standard
/// output among them).
enum class ExitCode {
  done = 0,
  check_failed = 1,
  usage = 2,
  bad_input = 3,
  diverged = 4,
  interrupted = 130,
  terminated = 143
};

/// What is wrong with a value as it was written, `found …, expected …`; empty where nothing is.
using FindFault = std::string (*)(const std::string& text);

/// An option of a command; each function returns it again.
class Option {
 public:
  explicit Option(CLI::Option& option) : option_(&option) {}

  /// From `least` to `most`; the type says whether numbers are whole.
  Option& within(int least, int most);
  Option& within(std::int64_t least, std::int64_t most);
  Option& within(double least, double most);
  Option& above_zero();  ///< and at most 1e9
  Option& from_zero();
  Option& from_zero(double most);
  Option& one_of(std::vector<std::string> names);
  Option& checked(FindFault find_fault, const std::string& type = "");

  /// Several values in one word.
  Option& several(char separator = ',');
  /// How many words it takes.
  Option& words(int least, int most);
  /// A file that the command writes when it is done. What cannot be written, is among the files that it
  /// reads, or is another such option's, too, is refused (InputError) before anything else is done.
  Option& written();
  /// A folder that it writes files into; one that it cannot write into is refused likewise.
  Option& written_into();
  Option& required();
  Option& needs(const Option& other);
  Option& excludes(const Option& other);

  /// What --help shows in place of the type, or of type and default.
  Option& typed(const std::string& type);
  Option& shown_as(const std::string& text);
  Option& in_group(const std::string& name);

 private:
  template <class Number>
  Option& range(Number least, Number most, const std::string& name = "");

  CLI::Option* option_;
};

class Command {
 public:
  /// `exit_code` receives how the command that is chosen ended; both outlive the parsing.
  Command(CLI::App& app, ExitCode& exit_code) : app_(&app), exit_code_(&exit_code) {}

  /// A command that only holds others, and ends early, with what there is, where it is interrupted.
  Command add_group(const std::string& name, const std::string& what);

  template <class Arguments>
  struct Added;
  /// A command that reads its options into an `Arguments` and hands it to `run`, which returns an ExitCode,
  /// or nothing where there is nothing to check.
  template <class Arguments, class Run>
  Added<Arguments> add(const std::string& name, const std::string& what, Run run);

  /// `value`, which outlives the parsing, holds the default, which --help shows unless it is empty. Of
  /// numbers, texts and paths, vectors of them, and numbers that may be absent.
  template <class Value>
  Option add_option(const std::string& names, Value& value, const std::string& what);
  Option add_flag(const std::string& name, bool& value, const std::string& what);

  /// What `take` makes a value of.
  Option add_text(const std::string& name, std::function<void(const std::string&)> take,
                  const std::string& what);

  /// One of several names, each of which stands for a value.
  template <class Value, class Target>
  Option add_choice(const std::string& name, Target& target,
                    std::vector<std::pair<std::string, Value>> choices, const std::string& what);

  /// Last in its --help.
  void add_footer(const std::string& text);

 private:
  Command add_command(const std::string& name, const std::string& what, std::function<ExitCode()> run);

  CLI::App* app_;
  ExitCode* exit_code_;
};

/// To be called once all commands are there. From then on each of their options that takes a number refuses
/// what is none (not a number, infinite, beyond its type's range, a sign where there can be none), before its
/// own checks, which not-a-number passes; any other refuses an empty text; and every refusal of an option's
/// value reads `found …, expected …`.
void check_values(CLI::App& program);
/// After that: throws CLI::ParseError for a list with an empty item, such as `0.1,,2`.
void check_lists(CLI::App& program, int argc, const char* const* argv);

template <class Arguments>
struct Command::Added {
  Command command;
  Arguments& arguments;
};

template <class Arguments, class Run>
Command::Added<Arguments> Command::add(const std::string& name, const std::string& what, Run run) {
  const auto arguments = std::make_shared<Arguments>();
  const auto run_with_them = [arguments, run] {
    if constexpr (std::is_void_v<std::invoke_result_t<Run, Arguments&>>) {
      run(*arguments);
      return ExitCode::done;
    } else {
      return run(*arguments);
    }
  };
  return {add_command(name, what, run_with_them), *arguments};
}

template <class Value, class Target>
Option Command::add_choice(const std::string& name, Target& target,
                           std::vector<std::pair<std::string, Value>> choices, const std::string& what) {
  std::vector<std::string> names;
  for (const auto& [text, value] : choices) names.push_back(text);
  const auto take = [&target, choices](const std::string& text) {
    for (const auto& [choice, value] : choices)
      if (choice == text) target = value;
  };
  return add_text(name, take, what).one_of(std::move(names));
}

}  // namespace lodestone
