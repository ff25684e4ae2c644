#include "tools/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>

namespace lodestone {
namespace {

constexpr int kBarCells = 24;
constexpr double kLeastPause = 0.1;  // s

double monotonic_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

ProgressLine::ProgressLine() : terminal_(isatty(STDERR_FILENO) == 1) {}

ProgressLine::~ProgressLine() {
  if (shown_) fmt::print(stderr, "\r\x1b[K");
}

void ProgressLine::show(const std::string& stage, double fraction) {
  const std::scoped_lock lock(mutex_);
  if (!terminal_ || monotonic_seconds() < next_s_) return;
  next_s_ = monotonic_seconds() + kLeastPause;
  shown_ = true;
  const int filled = int(std::clamp(fraction, 0.0, 1.0) * kBarCells);
  fmt::print(stderr, "\r\x1b[K[{:=<{}}{: <{}}] {:3.0f} % {}", "", filled, "", kBarCells - filled, 100 * fraction, stage);
  std::fflush(stderr);
}

Progress ProgressLine::function() {
  return [this](const std::string& stage, double fraction) { show(stage, fraction); };
}

}  // namespace lodestone
