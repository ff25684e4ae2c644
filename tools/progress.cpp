#include "tools/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "tools/interrupt.h"
#include "tools/terminal.h"

namespace lodestone {
namespace {

constexpr int kBarCells = 24;
constexpr double kLeastPause = 0.1;  // s

double monotonic_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Empty in the first second, in which it would be a guess.
std::string text_of_time_left(double fraction, double elapsed_s) {
  if (fraction <= 0.0 || fraction > 1.0 || elapsed_s < 1.0) return "";
  const double left_s = elapsed_s * (1.0 - fraction) / fraction;
  return left_s < 90.0 ? fmt::format(", {:.0f} s left,", left_s)
                       : fmt::format(", {:.0f} min left,", left_s / 60.0);
}

std::size_t terminal_columns() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1 ? size.ws_col : 80;
}

}  // namespace

ProgressLine::ProgressLine() : terminal_(isatty(STDERR_FILENO) == 1) {}

ProgressLine::~ProgressLine() {
  if (shown_) write_stderr("\r\x1b[K");
}

void ProgressLine::show(const std::string& stage, double fraction) {
  const std::scoped_lock lock(mutex_);
  if (!terminal_) return;
  const double now_s = monotonic_seconds();
  if (fraction < last_fraction_) start_s_ = now_s;  // another stage
  last_fraction_ = fraction;
  if (now_s < next_s_) return;
  next_s_ = now_s + kLeastPause;
  shown_ = true;
  const int filled = int(std::clamp(fraction, 0.0, 1.0) * kBarCells);
  const std::string line =
      fmt::format("[{:=<{}}{: <{}}] {:3.0f} %{} {}", "", filled, "", kBarCells - filled, 100 * fraction,
                  text_of_time_left(fraction, now_s - start_s_), printable(stage));
  write_stderr(fmt::format("\r\x1b[K{}", line.substr(0, terminal_columns() - 1)));
}

Progress ProgressLine::function() {
  return [this](const std::string& stage, double fraction) {
    show(stage, fraction);
    throw_if_interrupted();
  };
}

}  // namespace lodestone
