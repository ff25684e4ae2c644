// What assimp 5.2 must not be shown: files on which it loops for ever, or sets aside what a count in the file
// promises.
#pragma once

#include <filesystem>
#include <string>

namespace lodestone {

/// Throws InputError, naming the file, for a PLY file whose header or lists promise more than the file has,
/// and for a binary STL file with fewer bytes than its triangles. `extension` is in lower case and without
/// its dot; other formats pass.
void require_safe_for_assimp(const std::filesystem::path& file, const std::string& extension);

}  // namespace lodestone
