#include "tools/terminal.h"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cstdlib>

namespace lodestone {

bool stdout_has_styles() {
  static const bool has_styles = [] {
    const char *no_color = std::getenv("NO_COLOR"), *terminal = std::getenv("TERM");
    return isatty(STDOUT_FILENO) == 1 && (!no_color || !*no_color) && terminal &&
           std::string_view(terminal) != "dumb";
  }();
  return has_styles;
}

std::string styled(std::string_view text, Style style, bool has_styles) {
  static constexpr std::array kCodes{"1", "32", "1;31"};  // bold, green, bold red
  return has_styles ? fmt::format("\x1b[{}m{}\x1b[0m", kCodes[std::size_t(style)], text) : std::string(text);
}

}  // namespace lodestone
