#include "tools/warning.h"

#include <fmt/format.h>
#include <unistd.h>

#include "tools/printable.h"

namespace lodestone {

void warn(const std::string& message) {
  fmt::print(stderr, "{}lodestone: warning: {}\n", isatty(STDERR_FILENO) == 1 ? "\r\x1b[K" : "",
             printable(message));
}

}  // namespace lodestone
