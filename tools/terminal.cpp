#include "tools/terminal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstdio>
#include <cstdlib>

#include "reference/utf8.h"

namespace lodestone {
namespace {

constexpr std::size_t kLongest = 1000,
                      kShown = 400;  // bytes: of a text, and of each of its ends where it is longer

unsigned char byte_at(std::string_view text, std::size_t i) {
  return i < text.size() ? static_cast<unsigned char>(text[i]) : 0;
}

bool is_control(std::string_view character) {
  const unsigned char first = byte_at(character, 0);
  return first < 0x20 || first == 0x7f || (first == 0xc2 && byte_at(character, 1) < 0xa0);
}

std::string in_escapes(std::string_view bytes) {
  if (bytes == "\n") return "\\n";
  if (bytes == "\t") return "\\t";
  if (bytes == "\r") return "\\r";
  std::string text;
  for (const char byte : bytes) text += fmt::format("\\x{:02x}", static_cast<unsigned char>(byte));
  return text;
}

std::string escape_all(std::string_view text) {
  std::string shown;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t count = count_character_bytes(text, i);
    const std::string_view character = text.substr(i, count == 0 ? 1 : count);
    shown += count == 0 || is_control(character) ? in_escapes(character) : std::string(character);
    i += character.size();
  }
  return shown;
}

}  // namespace

std::string printable(std::string_view text) {
  if (text.size() <= kLongest) return escape_all(text);
  return fmt::format("{} ... ({} bytes) ... {}", escape_all(text.substr(0, kShown)), text.size() - 2 * kShown,
                     escape_all(text.substr(text.size() - kShown)));
}

void hold_standard_streams() {
  for (int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) != -1) continue;
    const int other_way = stream == STDIN_FILENO ? O_WRONLY : O_RDONLY;  // so that its use fails, as it would
    if (open("/dev/null", other_way) != stream) return;  // takes the first that is free: this one
  }
}

void write_stderr(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

void warn(const std::string& message) {
  write_stderr(fmt::format("{}lodestone: warning: {}\n", isatty(STDERR_FILENO) == 1 ? "\r\x1b[K" : "",
                           printable(message)));
}

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
