// Text as a terminal may be given it, and as it shows it.
#pragma once

#include <string>
#include <string_view>

namespace lodestone {

/// Texts of strangers (names of files, arguments, what stands in a scene): `text` in one line, with every
/// byte that a terminal obeys or that is no UTF-8 written as \n, \t or \x1b: the control characters of ASCII
/// and those from U+0080 to U+009F. Of a text of over 1,000 bytes, such as the name of a file may be, the
/// middle is left out.
std::string printable(std::string_view text);

/// Where standard input, output or stderr is closed, the next file that is opened would take its place, and
/// get what is said there: keeps the places. To be called before anything is opened.
void hold_standard_streams();

/// At once. Where stderr is closed or full nobody can be told, and the exit code says it alone.
void write_stderr(std::string_view text);

/// What goes on in spite of something: a line on stderr, in place of a line of progress that may stand there.
void warn(const std::string& message);

enum class Style { heading, good, bad };

/// Whether stdout is a terminal that shows styles: not in a pipe, and not where NO_COLOR is set
/// (no-color.org) or TERM is "dumb".
bool stdout_has_styles();

/// `text` in that style, with the terminal's codes around it; `text` itself where there are no styles.
std::string styled(std::string_view text, Style style, bool has_styles = stdout_has_styles());

}  // namespace lodestone
