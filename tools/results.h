// Results as programs read them.
#pragma once

#include <nlohmann/json.hpp>

namespace lodestone {

/// One object on stdout; with `"incomplete": true` where a signal has ended what it is of.
void print_json(nlohmann::ordered_json json);

}  // namespace lodestone
