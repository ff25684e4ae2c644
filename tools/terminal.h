// Text as a terminal shows it.
#pragma once

#include <string>
#include <string_view>

namespace lodestone {

enum class Style { heading, good, bad };

/// Whether stdout is a terminal that shows styles: not in a pipe, and not where NO_COLOR is set
/// (no-color.org) or TERM is "dumb".
bool stdout_has_styles();

/// `text` in that style, with the terminal's codes around it; `text` itself where there are no styles.
std::string styled(std::string_view text, Style style, bool has_styles = stdout_has_styles());

}  // namespace lodestone
