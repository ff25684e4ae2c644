// Which share of a measurement: --shard I/N.
#pragma once

#include <optional>

#include "signature/measure/measurement.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace lodestone {

/// Adds --shard I/N, I from 1 to N, to `command`. `share` outlives the parsing and stays empty where it is
/// not given.
CLI::Option* add_share_argument(CLI::App& command, std::optional<Share>& share);

}  // namespace lodestone
