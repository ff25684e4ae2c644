// The project's own texts of HTML pages, in the program: tools/cmake/page_texts.cmake.
#pragma once

#include <optional>
#include <string_view>

namespace lodestone {

/// The text of tools/*/NAME (.html, .css, .js) or tests/baselines/NAME (.csv); none where there is no such
/// file.
std::optional<std::string_view> find_page_text(std::string_view name);

}  // namespace lodestone
