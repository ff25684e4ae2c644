// The three kinds of error, and no more: a bug of ours aborts with its values (`check_that`); bad input
// throws `InputError`; numerical trouble while stepping is counted in the step report. A step throws for such
// trouble only if one of ODE's own assertions fails: `SimulationError` (reference/simulation_error.h).
#pragma once

#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace lodestone {

/// What was given cannot be used: a file, YAML key, command-line argument or mesh, or at run time a time
/// step, an id, a state, a force, a material. The message reads `where: found …, expected …`. A function that
/// throws it has changed nothing, unless it says so: nothing is half-loaded, no body has moved.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message) : std::runtime_error(message) {}
};

/// Throws InputError `what: found …, expected …`.
[[noreturn]] void throw_input_error(std::string_view what, std::string_view found, std::string_view expected);

/// Aborts unless `holds`: that would be a bug of ours. The place, `contract` and `values` are written to
/// stderr before. Always on.
void check_that(bool holds, std::string_view contract, std::string_view values = "",
                const char* file = __builtin_FILE(),
                int line = __builtin_LINE());  // clang 14 has no std::source_location

/// Sets, for all threads, what is called with the message of such a bug before the process aborts, on the
/// thread that met it. It may write a log. If it throws, the process does not abort, but nothing of the
/// engine may be used any more. Empty: none, as at the start.
void set_assertion_handler(std::function<void(std::string_view message)> handler);

}  // namespace lodestone
