// Texts of strangers (names of files, arguments, what stands in a scene) as a terminal may be given them.
#pragma once

#include <string>
#include <string_view>

namespace lodestone {

/// `text` in one line, with every byte that a terminal obeys or that is no UTF-8 written as \n, \t or \x1b:
/// the control characters of ASCII and those from U+0080 to U+009F. Of a text of over 1,000 bytes, such as
/// the name of a file may be, the middle is left out.
std::string printable(std::string_view text);

}  // namespace lodestone
