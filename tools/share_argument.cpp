#include "tools/share_argument.h"

#include <CLI/CLI.hpp>
#include <charconv>
#include <string_view>

namespace lodestone {
namespace {

std::optional<int> whole_number(std::string_view text) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc{} && end == text.data() + text.size() && !text.empty() ? std::optional(number)
                                                                                   : std::nullopt;
}

std::optional<Share> share_from_text(std::string_view text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string_view::npos) return {};
  const auto index = whole_number(text.substr(0, slash)), count = whole_number(text.substr(slash + 1));
  if (!index || !count || *index < 1 || *index > *count) return {};
  return Share{*index - 1, *count};
}

}  // namespace

CLI::Option* add_share_argument(CLI::App& command, std::optional<Share>& share) {
  return command
      .add_option_function<std::string>(
          "--shard",
          [&share](const std::string& text) {
            share = share_from_text(text);
            if (!share)
              throw CLI::ValidationError("--shard", "found " + text + ", expected I/N with I from 1 to N");
          },
          "measure one share of the trials, the I-th of N; -o names its part (see merge)")
      ->type_name("I/N");
}

}  // namespace lodestone
