// Scenes written down for a moment, as a user's file would say them.
#pragma once

#include <span>
#include <string>

namespace lodestone {

/// What loading `text` as a scene file complains of; empty where it loads.
std::string scene_error_of(const std::string& text);

/// How many of `texts` load although they should not, or are refused without naming the file, the line and
/// `key`.
int count_unclear(std::span<const std::string> texts, const std::string& key);

}  // namespace lodestone
