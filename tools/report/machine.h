// What a figure depends on beside the code: the machine, and which code it is.
#pragma once

#include <string>

namespace lodestone {

/// Processor, cores, system, compiler and ODE's version in a line.
std::string describe_machine();

/// Of the working copy that the program was built from, "+" after it where that was changed; "unknown" where
/// it is no working copy.
std::string program_commit();

/// UTC, as 2026-11-21.
std::string today();

}  // namespace lodestone
