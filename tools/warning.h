// What goes on in spite of something, on stderr.
#pragma once

#include <string>

namespace lodestone {

/// A line on stderr, in place of a line of progress that may stand there.
void warn(const std::string& message);

}  // namespace lodestone
