// What these programs find out about an installed Lodestone: each check says what was asked and what came of
// it, and a failed one makes the program fail.
#pragma once

#include <cstdio>

namespace check {

inline int failures = 0;

inline void that(bool holds, const char* what) {
  std::printf("%s %s\n", holds ? "ok  " : "FAIL", what);
  failures += !holds;
}

/// With the value that was found and its bounds.
inline void within(double value, double least, double most, const char* what) {
  const bool holds = value >= least && value <= most;
  std::printf("%s %s: %.6g, of %.6g to %.6g\n", holds ? "ok  " : "FAIL", what, value, least, most);
  failures += !holds;
}

inline int result() { return failures > 0; }

}  // namespace check
