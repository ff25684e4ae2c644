#include "tools/argument_checks.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <string_view>

namespace lodestone {
namespace {

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

std::string find_integer_fault(const std::string& text) {
  char* end = nullptr;
  errno = 0;
  std::strtoll(text.c_str(), &end, 0);
  return is_whole(text, end) && errno == 0 ? "" : fmt::format("found '{}', expected a whole number", text);
}

std::string find_unsigned_fault(const std::string& text) {
  char* end = nullptr;
  errno = 0;
  std::strtoull(text.c_str(), &end, 0);  // which turns a negative number round to a large one
  const bool has_sign = text.find('-') != std::string::npos;
  return is_whole(text, end) && errno == 0 && !has_sign
             ? ""
             : fmt::format("found '{}', expected a whole number from 0 on", text);
}

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

void check_numbers(CLI::Option& option) {
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
}

}  // namespace

void check_numbers(CLI::App& program) {
  for (CLI::Option* option : program.get_options()) check_numbers(*option);
  for (CLI::App* command : program.get_subcommands([](CLI::App*) { return true; })) check_numbers(*command);
}

}  // namespace lodestone
