// What this program has asked operator new for, counted: steps of a warm level allocate nothing.
#pragma once

#include <cstdint>

namespace lodestone {

/// Calls of operator new so far; constant where a sanitizer brings its own.
std::int64_t allocations();
/// Held at present, as the allocator rounds it.
std::int64_t bytes_held();

}  // namespace lodestone
