#include "tools/command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string_view>

#include "reference/error.h"
#include "reference/output_file.h"
#include "tools/interrupt.h"

namespace lodestone {
namespace {

// The names of validators.
constexpr const char* kWritten = "written";
constexpr const char* kWrittenInto = "written into";

bool has_mark(CLI::Option& option, const char* validator) {
  try {
    option.get_validator(validator);
    return true;
  } catch (const CLI::OptionNotFound&) {
    return false;
  }
}

/// Of an option that takes one word; its default counts, too.
std::filesystem::path place_of(const CLI::Option& option) {
  return option.count() > 0 ? option.results().front() : option.get_default_str();
}

/// Where what `option` names may be read: a mesh in the folders of --mesh-path, too.
std::vector<std::filesystem::path> places_read(const CLI::App& command, const CLI::Option& option) {
  const CLI::Option* folders = command.get_option_no_throw("--mesh-path");
  std::vector<std::filesystem::path> places;
  for (const std::string& name : option.results()) {
    places.push_back(name);
    if (!folders) continue;
    for (const std::filesystem::path folder : folders->results()) places.push_back(folder / name);
  }
  return places;
}

/// That `file`, which `option` writes, is no other's.
void check_own(const CLI::App& command, const std::filesystem::path& file, CLI::Option& option,
               CLI::Option& other) {
  const auto refuse = [&](const char* does) {
    throw_input_error(file.string(), fmt::format("the file that {} {}", other.get_name(), does),
                      fmt::format("another one for {}", option.get_name()));
  };
  if (has_mark(other, kWritten)) {
    const std::filesystem::path there = place_of(other);
    if (!there.empty() && is_one_file(file, there)) refuse("writes");
    return;
  }
  for (const std::filesystem::path& place : places_read(command, other))
    if (is_one_file(file, place)) refuse("reads");
}

void check_written(CLI::App& command) {
  const std::vector<CLI::Option*> options = command.get_options();
  for (CLI::Option* option : options) {
    const bool is_folder = has_mark(*option, kWrittenInto);
    if (!is_folder && !has_mark(*option, kWritten)) continue;
    const std::filesystem::path place = place_of(*option);
    if (place.empty()) continue;
    const std::string fault = find_writing_fault(is_folder ? place / "file" : place);
    if (!fault.empty())
      throw_input_error(place.string(), fault,
                        is_folder ? "a folder for results" : "a file that can be written");
    for (CLI::Option* other : options)
      if (!is_folder && other != option) check_own(command, place, *option, *other);
  }
}

/// Whether --help has a default to show.
template <class Value>
bool has_default(const Value& value) {
  if constexpr (std::is_arithmetic_v<Value>)
    return true;
  else if constexpr (requires { value.empty(); })
    return !value.empty();
  else
    return value.has_value();
}

bool is_whole(const std::string& text, const char* end) {
  return !text.empty() && end == text.c_str() + text.size();
}

std::string find_real_fault(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  return is_whole(text, end) && std::isfinite(value)
             ? ""
             : fmt::format("found '{}', expected a finite number", text);
}

/// Digits, with a sign or without; CLI11 reads a 0 before them as base 8, and 0x as 16.
template <class Integer>
bool is_integer(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  Integer value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return false;
  if (text.starts_with('-')) text.remove_prefix(1);
  return text.size() == 1 || text[0] != '0';
}

std::string find_integer_fault(const std::string& text) {
  return is_integer<std::int64_t>(text) ? "" : fmt::format("found '{}', expected a whole number", text);
}

std::string find_unsigned_fault(const std::string& text) {
  return is_integer<std::uint64_t>(text) ? ""
                                         : fmt::format("found '{}', expected a whole number from 0 on", text);
}

std::string find_absence(const std::string& text) { return text.empty() ? "found '', expected a name" : ""; }

// "FLOAT in [0 - 1]", "POSITIVE", "{auto,full}" are what a usage shows; a sentence says it in words.
std::string words_for(const std::string& description) {
  const auto after = [&](std::string_view head, std::string_view words) -> std::string {
    return description.starts_with(head) ? fmt::format("{} {}", words, description.substr(head.size())) : "";
  };
  for (const std::string& words : {after("FLOAT in ", "a number in"), after("INT in ", "a whole number in"),
                                   after("UINT in ", "a whole number in")})
    if (!words.empty()) return words;
  if (description.starts_with("{")) return "one of " + description;
  if (description == "POSITIVE") return "a number above 0";
  if (description == "NONNEGATIVE") return "a number from 0 on";
  return description.empty() ? "another value" : description;
}

// CLI11's own validators say what is wrong each in its own way.
void word_alike(CLI::Validator& validator) {
  validator.operation([check = validator](std::string& text) -> std::string {
    const std::string given = text;
    const std::string fault = check(text);
    if (fault.empty() || fault.starts_with("found ")) return fault;
    return fmt::format("found '{}', expected {}", given, words_for(check.get_description()));
  });
}

// Those of the option itself; CLI11 has no way to count them but to ask until it refuses.
void word_alike(CLI::Option& option) {
  try {
    for (int i = 0;; ++i) word_alike(*option.get_validator(i));
  } catch (const CLI::OptionNotFound&) {  // one past the last
  }
}

void check_values(CLI::Option& option) {
  word_alike(option);
  const std::string type = option.get_type_name();
  // A check of their own where they are words, such as 1/60, is left to them.
  const auto is_of = [&](std::string_view name) {
    return type == name || type.starts_with(fmt::format("{}:", name)) ||
           type.starts_with(fmt::format("{} ", name));
  };
  if (is_of("FLOAT"))
    option.transform(CLI::Validator([](std::string& text) { return find_real_fault(text); }, ""));
  else if (is_of("UINT"))
    option.transform(CLI::Validator([](std::string& text) { return find_unsigned_fault(text); }, ""));
  else if (is_of("INT"))
    option.transform(CLI::Validator([](std::string& text) { return find_integer_fault(text); }, ""));
  else if (option.get_items_expected_max() > 0)
    option.check(CLI::Validator([](std::string& text) { return find_absence(text); }, ""));
}

/// What the option itself says of `text`; empty where it takes it.
std::string find_fault(CLI::Option& option, std::string text) {
  try {
    for (int i = 0;; ++i)
      if (std::string fault = (*option.get_validator(i))(text); !fault.empty()) return fault;
  } catch (const CLI::OptionNotFound&) {  // one past the last
    return "";
  }
}

/// Throws where one of the items is empty, which CLI11 passes over.
void check_items(CLI::Option& option, const std::string& list) {
  const char delimiter = option.get_delimiter();
  for (std::size_t begin = 0, end = 0; end != std::string::npos && !list.empty(); begin = end + 1) {
    end = list.find(delimiter, begin);
    if (end == begin || begin == list.size())
      throw CLI::ValidationError(option.get_name(), find_fault(option, ""));
  }
}

}  // namespace

void check_lists(CLI::App& program, int argc, const char* const* argv) {
  CLI::App* command = &program;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto inner = command->get_subcommands([&](CLI::App* app) { return app->get_name() == word; });
    if (!inner.empty()) {
      command = inner.front();
      continue;
    }
    const std::size_t equals = word.find('=');
    CLI::Option* option =
        word.starts_with('-') ? command->get_option_no_throw(word.substr(0, equals)) : nullptr;
    if (!option || option->get_delimiter() == '\0') continue;
    if (equals != std::string::npos)
      check_items(*option, word.substr(equals + 1));
    else if (i + 1 < argc)
      check_items(*option, argv[++i]);
  }
}

template <class Number>
Option& Option::range(Number least, Number most, const std::string& name) {
  option_->check(CLI::Range(least, most, name));
  return *this;
}

Option& Option::within(int least, int most) { return range(least, most); }
Option& Option::within(std::int64_t least, std::int64_t most) { return range(least, most); }
Option& Option::within(double least, double most) { return range(least, most); }
Option& Option::above_zero() { return range(1e-9, 1e9, "POSITIVE"); }

Option& Option::from_zero(double most) { return range(0.0, most, "NONNEGATIVE"); }

Option& Option::from_zero() {
  option_->check(CLI::NonNegativeNumber);
  return *this;
}

Option& Option::one_of(std::vector<std::string> names) {
  option_->check(CLI::IsMember(std::move(names)));
  return *this;
}

Option& Option::checked(FindFault find_fault, const std::string& type) {
  option_->check(find_fault, type);
  return *this;
}

Option& Option::several(char separator) {
  option_->delimiter(separator)->allow_extra_args(false);
  return *this;
}

Option& Option::words(int least, int most) {
  option_->expected(least, most);
  return *this;
}

Option& Option::written() {
  option_->check(CLI::Validator([](std::string&) { return std::string(); }, "", kWritten));
  return *this;
}

Option& Option::written_into() {
  option_->check(CLI::Validator([](std::string&) { return std::string(); }, "", kWrittenInto));
  return *this;
}

Option& Option::required() {
  option_->required();
  return *this;
}

Option& Option::needs(const Option& other) {
  option_->needs(other.option_);
  return *this;
}

Option& Option::excludes(const Option& other) {
  option_->excludes(other.option_);
  return *this;
}

Option& Option::typed(const std::string& type) {
  option_->type_name(type);
  return *this;
}

Option& Option::shown_as(const std::string& text) {
  option_->option_text(text);
  return *this;
}

Option& Option::in_group(const std::string& name) {
  option_->group(name);
  return *this;
}

Command Command::add_group(const std::string& name, const std::string& what) {
  CLI::App* group = app_->add_subcommand(name, what);
  group->require_subcommand(1);
  group->preparse_callback([](std::size_t) { catch_interrupts(); });
  return {*group, *exit_code_};
}

Command Command::add_command(const std::string& name, const std::string& what,
                             std::function<ExitCode()> run) {
  CLI::App* command = app_->add_subcommand(name, what);
  command->callback([run = std::move(run), exit_code = exit_code_, command] {
    check_written(*command);
    *exit_code = run();
  });
  return {*command, *exit_code_};
}

template <class Value>
Option Command::add_option(const std::string& names, Value& value, const std::string& what) {
  CLI::Option* option = app_->add_option(names, value, what);
  if (has_default(value)) option->capture_default_str();
  return Option(*option);
}

// What values there are: named here, they are compiled once.
#define LODESTONE_OPTION_OF(...) \
  template Option Command::add_option(const std::string&, __VA_ARGS__&, const std::string&)
LODESTONE_OPTION_OF(int);
LODESTONE_OPTION_OF(std::int64_t);
LODESTONE_OPTION_OF(std::uint64_t);
LODESTONE_OPTION_OF(double);
LODESTONE_OPTION_OF(std::string);
LODESTONE_OPTION_OF(std::filesystem::path);
LODESTONE_OPTION_OF(std::optional<int>);
LODESTONE_OPTION_OF(std::optional<std::uint64_t>);
LODESTONE_OPTION_OF(std::optional<double>);
LODESTONE_OPTION_OF(std::vector<int>);
LODESTONE_OPTION_OF(std::vector<double>);
LODESTONE_OPTION_OF(std::vector<std::string>);
LODESTONE_OPTION_OF(std::vector<std::filesystem::path>);
#undef LODESTONE_OPTION_OF

Option Command::add_flag(const std::string& name, bool& value, const std::string& what) {
  return Option(*app_->add_flag(name, value, what));
}

Option Command::add_text(const std::string& name, std::function<void(const std::string&)> take,
                         const std::string& what) {
  return Option(*app_->add_option_function<std::string>(name, std::move(take), what));
}

void Command::add_footer(const std::string& text) { app_->footer(text); }

void check_values(CLI::App& program) {
  for (CLI::Option* option : program.get_options()) check_values(*option);
  for (CLI::App* command : program.get_subcommands([](CLI::App*) { return true; })) check_values(*command);
}

}  // namespace lodestone
