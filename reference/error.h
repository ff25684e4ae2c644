// The three kinds of error, and no more: a bug of ours aborts with its values (`check_that`); bad input
// throws `InputError`; numerical trouble while stepping is counted in the step report. Only where ODE gives
// up by an assertion of its own does a step throw: `SimulationError` (reference/simulation_error.h).
#pragma once

#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace lodestone {

/// What was given cannot be used: a file, YAML key, command-line argument or mesh, or at run time a time
/// step, an id, a state, a force, a material. The message reads `where: found …, expected …`. Whatever throws
/// it has changed nothing: nothing is half-loaded, no body moved.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message) : std::runtime_error(message) {}
};

/// Throws InputError `what: found …, expected …`.
[[noreturn]] void throw_input_error(std::string_view what, std::string_view found, std::string_view expected);

/// Aborts, naming the place and `values`, where something that must hold does not: a bug of ours. Always on.
void check_that(bool holds, std::string_view contract, std::string_view values = "",
                const char* file = __builtin_FILE(),
                int line = __builtin_LINE());  // clang 14 has no std::source_location

/// What is called with the message of such a bug before the process aborts, on the thread that met it; it may
/// write a log, or throw, and then nothing aborts (and nothing of the engine may be used any more). Empty:
/// none, as at the start. For all threads.
void set_assertion_handler(std::function<void(std::string_view message)> handler);

}  // namespace lodestone
