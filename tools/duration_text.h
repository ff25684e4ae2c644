// Milliseconds in a table.
#pragma once

#include <fmt/format.h>

#include <string>

namespace lodestone {

/// Two decimals, and below a tenth of a millisecond two digits, so that nothing reads as 0.00.
inline std::string text_of_ms(double ms) {
  return ms >= 0.1 || ms <= 0.0 ? fmt::format("{:.2f}", ms) : fmt::format("{:.2g}", ms);
}

}  // namespace lodestone
