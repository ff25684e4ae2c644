// `--methods` of the comparisons.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace lodestone {

/// What is wrong with the name of a method; empty where nothing is.
std::string find_method_fault(const std::string& name);

/// `methods` holds the default and outlives the parsing; names that make_drop_methods does not know are
/// refused.
void add_methods_argument(CLI::App& command, std::vector<std::string>& methods);

}  // namespace lodestone
