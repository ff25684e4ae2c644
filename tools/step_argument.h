// Time steps as arguments: `0.01` or `1/60`.
#pragma once

#include <string>
#include <vector>

namespace lodestone {

/// What is wrong with `text` as a step; empty for a step within (0, 0.1] s.
std::string find_step_fault(const std::string& text);

/// In seconds, of texts without fault.
double step_of(const std::string& text);
std::vector<double> steps_of(const std::vector<std::string>& texts);

}  // namespace lodestone
