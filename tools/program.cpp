#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <utility>

#include "lod/version.h"
#include "reference/argument_error.h"
#include "reference/output_file.h"
#include "reference/simulation_error.h"
#include "scenes/yaml_cursor.h"
#include "tools/command.h"
#include "tools/commands.h"
#include "tools/interrupt.h"
#include "tools/results.h"
#include "tools/terminal.h"

namespace lodestone {
namespace {

constexpr const char* kExitCodes =
    "Results go to stdout, progress and errors to stderr.\n"
    "Exit codes: 0 done, 1 a check failed, 2 usage (the command line is wrong), 3 bad input (a shape or file "
    "cannot be used, or not\n"
    "written), 4 the simulation diverged, 130 interrupted, 143 terminated.";

void complain(std::string_view message) { write_stderr(fmt::format("lodestone: {}\n", printable(message))); }

// Of `group`, or of the group in it that was named, whose command is not one of those that it has; empty if
// that is not what is wrong. CLI11 says no more than that one is required.
std::string find_command_fault(const CLI::App& group) {
  const auto chosen = group.get_subcommands();
  if (!chosen.empty()) return find_command_fault(*chosen.front());
  std::vector<std::string> names;
  for (const CLI::App* command : group.get_subcommands({})) names.push_back(command->get_name());
  if (names.empty()) return "";
  const std::vector<std::string> words = group.remaining();
  const auto first =
      std::ranges::find_if(words, [](const std::string& word) { return !word.starts_with('-'); });
  const std::string group_name = group.get_parent() ? group.get_name() + ": " : "";
  return fmt::format("{}found {}, expected one of {}", group_name,
                     first == words.end() ? "no command" : fmt::format("'{}'", *first),
                     fmt::join(names, ", "));
}

CLI::App& find_chosen(CLI::App& program) {
  CLI::App* command = &program;
  while (!command->get_subcommands().empty()) command = command->get_subcommands().front();
  return *command;
}

// Of words that no option or argument takes, the one that is most likely wrong.
std::string words_of_extras(const CLI::App& command) {
  const std::vector<std::string> words = command.remaining(true);
  const auto option =
      std::ranges::find_if(words, [](const std::string& word) { return word.starts_with('-'); });
  if (option == words.end())
    return fmt::format("{}: found '{}', expected no more arguments", command.get_name(),
                       words.empty() ? "" : words.front());
  std::vector<std::string> known;
  for (const CLI::Option* one : command.get_options())
    for (const std::string& name : one->get_lnames()) known.push_back("--" + name);
  return fmt::format("{}: found '{}', expected one of its options{}", command.get_name(), *option,
                     suggestion(option->substr(0, option->find('=')), known));
}

// What CLI11 says of its own, as our messages say it; all else as it is.
std::string words_of(CLI::App& program, const CLI::ParseError& error) {
  const CLI::App& command = find_chosen(program);
  const std::string said = error.what();
  // The name before `words`, and what stands after them.
  const auto split_at = [&](std::string_view words) -> std::optional<std::pair<std::string, std::string>> {
    const std::size_t at = said.find(words);
    if (at == said.npos) return std::nullopt;
    return std::pair(said.substr(0, at), said.substr(at + words.size()));
  };
  switch (CLI::ExitCodes(error.get_exit_code())) {
    case CLI::ExitCodes::RequiredError:
      if (const std::string fault = find_command_fault(program); !fault.empty()) return fault;
      if (const auto name = split_at(" is required")) {
        const CLI::Option* option = command.get_option_no_throw(name->first);
        return fmt::format("{}: found none, expected {}", name->first,
                           option ? option->get_description() : "one");
      }
      break;
    case CLI::ExitCodes::ExcludesError:
      if (const auto both = split_at(" excludes "))
        return fmt::format("{}: found it beside {}, expected one of them", both->first, both->second);
      break;
    case CLI::ExitCodes::RequiresError:
      if (const auto both = split_at(" requires "))
        return fmt::format("{}: found it without {}, expected both", both->first, both->second);
      break;
    case CLI::ExitCodes::ExtrasError:
      return words_of_extras(command);
    case CLI::ExitCodes::ArgumentMismatch:
      if (const auto name = split_at(": At Most 1 required but received "))
        return fmt::format("{}: found it {} times, expected once", name->first, name->second);
      for (const auto& [theirs, ours] : {std::pair(": At Most ", "at most"), {": At least ", "at least"}})
        if (const auto name = split_at(theirs)) {
          const std::string& numbers = name->second;  // "3 required but received 4"
          return fmt::format("{}: found {}, expected {} {}", name->first,
                             numbers.substr(numbers.rfind(' ') + 1), ours,
                             numbers.substr(0, numbers.find(' ')));
        }
      if (const auto name = split_at(": "); name && said.ends_with(" missing"))
        return fmt::format("{}: found no value, expected one", name->first);
      break;
    default:
      break;
  }
  return said;
}

// The settings of a call have the names of options, but for their dashes.
std::string with_dashes(CLI::App& program, const std::string& message) {
  std::string name = "--" + message.substr(0, message.find(": found "));
  std::ranges::replace(name, '_', '-');
  return find_chosen(program).get_option_no_throw(name) ? name + message.substr(message.find(": found "))
                                                        : message;
}

// CLI11's own exit codes are not ours.
ExitCode explain(CLI::App& program, const CLI::ParseError& error) {
  if (error.get_exit_code() == 0) {  // help was asked for
    program.exit(error, std::cout, std::cerr);
    return ExitCode::done;
  }
  complain(words_of(program, error));
  write_stderr("Run with --help for more information.\n");
  return ExitCode::usage;
}

// "Permission denied" within a sentence.
std::string words_of_error(const std::error_code& error) {
  std::string words = error.message();
  if (!words.empty()) words[0] = char(std::tolower(static_cast<unsigned char>(words[0])));
  return words;
}

// Names the place that `error` does not name first, as the messages of ours do.
std::string text_of(const std::filesystem::filesystem_error& error) {
  return fmt::format("{}: found {}, expected a file that can be used", error.path1().string(),
                     words_of_error(error.code()));
}

bool wants_json(const CLI::App& command) {
  const CLI::Option* json = command.get_option_no_throw("--json");
  const auto chosen = command.get_subcommands();
  return (json && json->count() > 0) ||
         std::ranges::any_of(chosen, [](const CLI::App* inner) { return wants_json(*inner); });
}

void parse(CLI::App& program, int argc, char** argv, ExitCode& exit_code) {
  try {
    check_lists(program, argc, argv);
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    exit_code = explain(program, error);
  } catch (const ArgumentError& error) {
    throw ArgumentError(with_dashes(program, error.what()));
  } catch (const Interrupted&) {  // before there was any part of a result
    if (wants_json(program)) print_json(nlohmann::ordered_json::object());
  }
  if (!is_interrupted()) return;
  if (!wants_json(program)) fmt::print("INCOMPLETE: {}\n", Interrupted().what());
  complain(Interrupted().what());
}

// What came to standard output must have got there: a full disk shows when the last of it is written.
void check_standard_output() {
  errno = 0;
  std::cout.flush();
  if (std::fflush(stdout) != 0 || std::ferror(stdout) || !std::cout)
    throw_file_error("standard output", errno != 0 ? errno : EIO, "room for the results");
}

void add_compare_commands(Command& program) {
  Command compare = program.add_group("compare", "error against the truth, beside cost");
  for (const auto add :
       {add_compare_drop_command, add_compare_pile_command, add_compare_return_command,
        add_compare_errors_command, add_compare_shapes_command, add_compare_conditions_command,
        add_compare_materials_command, add_compare_scores_command})
    add(compare);
}

void add_bench_commands(Command& program) {
  Command bench = program.add_group("bench", "what the engine withstands, and what it costs");
  for (const auto add : {add_bench_hard_cases_command, add_bench_full_level_command, add_bench_table1_command,
                         add_bench_drops_command, add_bench_broad_phase_command, add_bench_settled_command,
                         add_bench_budget_command, add_bench_rungs_command, add_bench_transitions_command,
                         add_bench_attached_command, add_bench_churn_command, add_bench_endurance_command})
    add(bench);
}

}  // namespace

void add_commands(Command& program) {
  for (const auto add :
       {add_run_command, add_view_command, add_replay_command, add_compare_commands, add_sign_command,
        add_merge_command, add_inspect_command, add_demo_command, add_bench_commands, add_report_command})
    add(program);
}

ExitCode run_lodestone(int argc, char** argv) {
  hold_standard_streams();
  ExitCode exit_code = ExitCode::done;
  try {
    CLI::App program("Simulation level of detail for rigid bodies, on ODE", "lodestone");
    program.require_subcommand(1);
    program.footer(kExitCodes);
    program.set_version_flag("--version", "lodestone " LODESTONE_VERSION_STRING,
                             "Print the version, and exit");
    Command commands(program, exit_code);
    add_commands(commands);
    check_values(program);
    parse(program, argc, argv, exit_code);
    check_standard_output();
  } catch (const ArgumentError& error) {
    complain(error.what());
    return ExitCode::usage;
  } catch (const std::filesystem::filesystem_error& error) {
    complain(text_of(error));
    return ExitCode::bad_input;
  } catch (const std::system_error& error) {
    complain(std::ferror(stdout) ? fmt::format("standard output: found {}, expected room for the results",
                                               words_of_error(error.code()))
                                 : error.what());
    return ExitCode::bad_input;
  } catch (const std::bad_alloc&) {
    complain("memory: found less than this needs, expected a smaller scene, shape or number of trials");
    return ExitCode::bad_input;
  } catch (const SimulationError& error) {
    complain(error.what());
    return ExitCode::diverged;
  } catch (const std::exception& error) {  // InputError, and what the standard library throws of itself
    complain(error.what());
    return ExitCode::bad_input;
  }
  return is_interrupted() ? interrupted_exit_code() : exit_code;
}

}  // namespace lodestone
