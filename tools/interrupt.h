// SIGINT and SIGTERM: a long command ends after the step or trial it is at, with what there is.
#pragma once

#include <exception>

#include "tools/command.h"

namespace lodestone {

/// From now on the first SIGINT or SIGTERM is only noted, for commands that ask after each step or trial, and
/// a second one ends the process at once. A signal that the process was started to ignore (as in the
/// background of a shell script) stays ignored.
void catch_interrupts();

/// The signal that was noted; 0: none.
int interrupting_signal();
inline bool is_interrupted() { return interrupting_signal() != 0; }

/// 128 and the signal's number, as shells have it: 130 for SIGINT, 143 for SIGTERM. Only where one was noted.
ExitCode interrupted_exit_code();

/// Ends what has no part of a result to show, or whose caller keeps the parts that are whole.
class Interrupted : public std::exception {
 public:
  const char* what() const noexcept override;
};
void throw_if_interrupted();  ///< Interrupted

/// Lets `measure` fill in its parts one by one: where it is interrupted, those that are whole stay.
template <class Measure>
void until_interrupted(Measure measure) {
  try {
    measure();
  } catch (const Interrupted&) {  // the program's end says it
  }
}

}  // namespace lodestone
