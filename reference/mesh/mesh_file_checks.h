// What assimp 5.2 must not be shown: files on which it loops for ever, runs out of memory or out of stack.
#pragma once

#include <filesystem>
#include <string>

namespace lodestone {

/// Throws InputError, naming the file, for a PLY header without its end or that promises more elements than the file
/// has bytes, and for glTF nested too deep. `extension` is in lower case and without its dot; other formats pass.
void require_safe_for_assimp(const std::filesystem::path& file, const std::string& extension);

}  // namespace lodestone
