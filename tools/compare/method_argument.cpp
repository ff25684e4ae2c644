#include "tools/compare/method_argument.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>

#include "tools/compare/drop_method.h"

namespace lodestone {

std::string find_method_fault(const std::string& name) {
  if (is_drop_method(name)) return "";
  return fmt::format("found '{}', expected some of {}, full_2 to full_64", name,
                     fmt::join(drop_method_names(), ", "));
}

void add_methods_argument(CLI::App& command, std::vector<std::string>& methods) {
  command
      .add_option("--methods", methods,
                  fmt::format("some of {}; full_N for the full level at N substeps",
                              fmt::join(drop_method_names(), ",")))
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(find_method_fault, "METHODS")
      ->capture_default_str();
}

}  // namespace lodestone
