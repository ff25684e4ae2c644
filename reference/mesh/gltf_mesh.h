// Reading the triangles of a glTF 2.0 file. Ours instead of assimp's, whose importer trusts the lengths,
// strides and sparse indices of a file: every one of them is checked here against the bytes that are there.
#pragma once

#include <filesystem>
#include <string>

#include "reference/mesh/mesh.h"

namespace lodestone {

/// Every triangle of the file's scene, where its nodes put it. `extension` is gltf or glb. Buffers lie in the
/// file or in the file's own folder. Skins, morph targets and all that is not geometry are passed over.
/// Throws InputError, naming the file, for what is not as the specification has it, and for compressed
/// meshes. https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html
Mesh read_gltf_mesh(const std::filesystem::path& file, const std::string& extension,
                    const MeshLoadSettings& settings);

}  // namespace lodestone
