// Text in UTF-8 (RFC 3629).
#pragma once

#include <cstddef>
#include <string_view>

namespace lodestone {

/// Bytes of the character that begins at `at`, or 0 where none does: no overlong form, no surrogate, none
/// beyond U+10FFFF.
inline std::size_t count_character_bytes(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : static_cast<unsigned char>(0);
  };
  const unsigned char first = byte(at), second = byte(at + 1);
  if (first < 0x80) return 1;
  const std::size_t count = first >= 0xc2 && first <= 0xdf   ? 2
                            : first >= 0xe0 && first <= 0xef ? 3
                            : first >= 0xf0 && first <= 0xf4 ? 4
                                                             : 0;
  for (std::size_t k = 1; k < count; ++k)
    if ((byte(at + k) & 0xc0) != 0x80) return 0;
  const bool is_wrong = (first == 0xe0 && second < 0xa0) || (first == 0xed && second > 0x9f) ||
                        (first == 0xf0 && second < 0x90) || (first == 0xf4 && second > 0x8f);
  return is_wrong ? 0 : count;
}

}  // namespace lodestone
