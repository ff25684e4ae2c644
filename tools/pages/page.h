// Pages that are one HTML file each and ask the network for nothing.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace lodestone {

/// The page whose text is tools/*/NAME, with its markers replaced: `{{text:FILE}}` by a text of the project's
/// own (find_page_text), `{{library:FOLDER/FILE}}` by a file of Debian's libjs-… packages below
/// /usr/share/javascript, `{{title}}` by `title`, and `{{data}}` by `data`, which a script finds as JSON.
/// Throws InputError where a library is not installed.
std::string make_page(std::string_view name, std::string_view title, const nlohmann::ordered_json& data);

/// Writes `page` through a temporary file beside it. Throws InputError where it cannot be written.
void save_page(const std::filesystem::path& file, const std::string& page);

}  // namespace lodestone
