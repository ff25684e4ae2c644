// The three kinds of error, and no more: a broken contract aborts with its values (`check_that`); bad input
// throws `InputError`; numerical trouble while stepping is counted in the step report and never thrown.
#pragma once

#include <source_location>
#include <stdexcept>
#include <string>
#include <string_view>

namespace lodestone {

/// A file, YAML key, command-line argument or mesh is bad. The message reads `file:line: key: found …, expected …`.
/// Thrown only by `load_*`, `make_*` and the command line; nothing is left half-loaded.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message) : std::runtime_error(message) {}
};

/// Aborts, naming the place and `values`, where the caller broke a contract. Always on.
void check_that(bool holds, std::string_view contract, std::string_view values = "",
                std::source_location place = std::source_location::current());

}  // namespace lodestone
