// A line of progress on stderr, on a terminal only.
#pragma once

#include <mutex>
#include <string>

#include "signature/signature_source.h"

namespace lodestone {

/// One line with a bar and, once it can be told, the time left; rewritten at most ten times a second, cut to
/// the terminal's width and cleared at the end. Writes nothing where stderr is no terminal. May be called
/// from several threads.
class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// `fraction` done, 0 … 1.
  void show(const std::string& stage, double fraction);

  /// For those who report to a function; valid as long as this line. Throws Interrupted once the program was
  /// (tools/interrupt.h).
  Progress function();

 private:
  bool terminal_;
  std::mutex mutex_;
  bool shown_ = false;
  double next_s_ = 0.0;                         // monotonic time before which nothing is written
  double start_s_ = 0.0, last_fraction_ = 2.0;  // of what counts from 0 to 1 now
};

/// What `measure` makes of `settings`, their `progress` shown on a line meanwhile.
template <class Settings, class Measure>
auto with_progress(Settings settings, Measure measure) {
  ProgressLine line;
  settings.progress = line.function();
  return measure(settings);
}

}  // namespace lodestone
