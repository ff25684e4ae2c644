// What assimp 5.2 must not be shown: files on which it loops for ever, or sets aside what a count in the file
// promises, and those of whose faults it does not say where they are.
#pragma once

#include <filesystem>
#include <string>

namespace lodestone {

/// Throws InputError, naming the file, for a PLY file whose header or lists promise more than the file has,
/// for a binary STL file with fewer bytes than its triangles, and, with the line, for an OBJ file with a
/// vertex that is not three finite numbers or a face of vertices that there are not. `extension` is in lower
/// case and without its dot; other formats pass.
void require_safe_for_assimp(const std::filesystem::path& file, const std::string& extension);

}  // namespace lodestone
