#include "tools/step_argument.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

namespace lodestone {
namespace {

std::optional<double> parse_number(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<double> parse_step(std::string_view text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string_view::npos) return parse_number(text);
  const auto above = parse_number(text.substr(0, slash)), below = parse_number(text.substr(slash + 1));
  if (!above || !below) return std::nullopt;
  return *above / *below;
}

}  // namespace

std::string find_step_fault(const std::string& text) {
  const auto step = parse_step(text);
  if (step && *step >= 1e-9 && *step <= 0.1) return "";
  return fmt::format("found '{}', expected seconds from 1e-9 to 0.1, such as 0.01 or 1/60", text);
}

double step_of(const std::string& text) { return parse_step(text).value(); }

std::vector<double> steps_of(const std::vector<std::string>& texts) {
  std::vector<double> steps;
  for (const std::string& text : texts) steps.push_back(step_of(text));
  return steps;
}

}  // namespace lodestone
