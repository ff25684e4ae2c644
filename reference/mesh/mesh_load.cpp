// Reading mesh files, glTF by ourselves and the rest through assimp. Assimp is trusted with the syntax only:
// it guesses the format from the contents, lets NaN and 1e39 through, and follows file names inside files, so
// the importer, the file it may open and every number are ours to check.
#include <assimp/BaseImporter.h>
#include <assimp/DefaultIOSystem.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cstdint>
#include <memory>
#include <set>

#include "reference/error.h"
#include "reference/mesh/gltf_mesh.h"
#include "reference/mesh/mesh.h"
#include "reference/mesh/mesh_child.h"
#include "reference/mesh/mesh_file_checks.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExtensions[] = {"obj", "ply", "stl", "gltf", "glb", "3ds"};

[[noreturn]] void refuse(const fs::path& file, const std::string& found, const std::string& expected) {
  throw InputError(fmt::format("{}: found {}, expected {}", file.string(), found, expected));
}

/// In lower case, without its dot; empty where there is none.
std::string extension_of(const fs::path& file) {
  std::string extension = file.extension().string();
  if (!extension.empty()) extension.erase(0, 1);
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  return extension;
}

void require_readable(const fs::path& file, const MeshLoadSettings& settings) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (!fs::exists(status)) refuse(file, "no such file", "a mesh file");
  if (!fs::is_regular_file(status))
    refuse(file, fs::is_directory(status) ? "a folder" : "no regular file", "a mesh file");
  const std::uintmax_t bytes = fs::file_size(file, error);
  if (error || bytes == 0) refuse(file, error ? error.message() : "an empty file", "a mesh file");
  if (bytes > settings.max_bytes)
    refuse(file, fmt::format("{} bytes", bytes), fmt::format("at most {}", settings.max_bytes));
}

/// Lets assimp open the file itself; no other file, however it is named.
class GuardedFiles : public Assimp::DefaultIOSystem {
 public:
  explicit GuardedFiles(const fs::path& file) : file_(fs::canonical(file)) {}

  Assimp::IOStream* Open(const char* name, const char* mode) override {
    return is_allowed(name) && mode[0] == 'r' ? Assimp::DefaultIOSystem::Open(name, mode) : nullptr;
  }
  bool Exists(const char* name) const override { return is_allowed(name); }

 private:
  bool is_allowed(const char* name) const {
    std::error_code error;
    const fs::path path = fs::canonical(name, error);
    return !error && path == file_;
  }

  fs::path file_;
};

/// Leaves only the importer of `extension`.
void keep_importer_of(Assimp::Importer& importer, const std::string& extension) {
  for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
    Assimp::BaseImporter* one = importer.GetImporter(i);
    std::set<std::string> extensions;
    one->GetExtensionList(extensions);
    if (extensions.contains(extension)) continue;
    importer.UnregisterLoader(one);
    delete one;
  }
}

/// Assimp's triangulation aborts on faces without corners.
void require_corners(const aiScene& scene, const fs::path& file) {
  for (unsigned i = 0; i < scene.mNumMeshes; ++i)
    for (unsigned k = 0; k < scene.mMeshes[i]->mNumFaces; ++k)
      if (scene.mMeshes[i]->mFaces[k].mNumIndices == 0)
        refuse(file, fmt::format("no corners at face {}", k), "at least 3");
}

/// Appends the triangles of `part`, placed by `transform`. Points and lines are passed over.
void append(Mesh& mesh, const aiMesh& part, const aiMatrix4x4& transform, const fs::path& file) {
  const int first = int(mesh.vertices.size());
  for (unsigned i = 0; i < part.mNumVertices; ++i) {
    const aiVector3D v = transform * part.mVertices[i];
    mesh.vertices.emplace_back(v.x, v.y, v.z);
    if (!mesh.vertices.back().allFinite())
      refuse(file,
             fmt::format("vertex {} at ({}, {}, {})", i, part.mVertices[i].x, part.mVertices[i].y,
                         part.mVertices[i].z),
             "finite coordinates");
  }
  for (unsigned i = 0; i < part.mNumFaces; ++i) {
    const aiFace& face = part.mFaces[i];
    if (face.mNumIndices != 3) continue;
    for (int k = 0; k < 3; ++k)
      if (face.mIndices[k] >= part.mNumVertices)
        refuse(file, fmt::format("index {} in face {}", face.mIndices[k], i),
               fmt::format("less than {}", part.mNumVertices));
    mesh.faces.push_back(
        {first + int(face.mIndices[0]), first + int(face.mIndices[1]), first + int(face.mIndices[2])});
  }
}

/// A mesh of the scene and where a node puts it.
struct PlacedPart {
  const aiMesh* mesh;
  aiMatrix4x4 transform;
};

std::vector<PlacedPart> parts_of(const aiScene& scene) {
  std::vector<PlacedPart> parts;
  std::vector<std::pair<const aiNode*, aiMatrix4x4>> open{{scene.mRootNode, aiMatrix4x4()}};
  while (!open.empty()) {
    const auto [node, above] = open.back();
    open.pop_back();
    const aiMatrix4x4 transform = above * node->mTransformation;
    for (unsigned i = 0; i < node->mNumMeshes; ++i)
      parts.push_back({scene.mMeshes[node->mMeshes[i]], transform});
    for (unsigned i = node->mNumChildren; i-- > 0;) open.emplace_back(node->mChildren[i], transform);
  }
  return parts;
}

/// Before any is copied: one mesh may be placed many times.
void require_few(const std::vector<PlacedPart>& parts, const fs::path& file, std::uint64_t max_faces) {
  std::uint64_t faces = 0, vertices = 0;
  for (const PlacedPart& part : parts) faces += part.mesh->mNumFaces, vertices += part.mesh->mNumVertices;
  const auto refuse_many = [&](std::uint64_t found, const char* what, std::uint64_t most) {
    refuse(file, fmt::format("{} {}", found, what),
           fmt::format("at most {} (simplify the mesh first)", most));
  };
  if (faces > max_faces) refuse_many(faces, "faces", max_faces);
  if (vertices > 3 * max_faces) refuse_many(vertices, "vertices", 3 * max_faces);
}

/// Every mesh of the scene, joined, each where its nodes put it.
Mesh join(const aiScene& scene, const fs::path& file, const MeshLoadSettings& settings) {
  const std::vector<PlacedPart> parts = parts_of(scene);
  require_few(parts, file, std::uint64_t(settings.max_faces));
  Mesh mesh;
  for (const PlacedPart& part : parts) append(mesh, *part.mesh, part.transform, file);
  return mesh;
}

Mesh read_with_assimp(const fs::path& file, const std::string& extension, const MeshLoadSettings& settings) {
  require_safe_for_assimp(file, extension);
  Assimp::Importer importer;
  importer.SetIOHandler(new GuardedFiles(file));  // the importer owns it
  keep_importer_of(importer, extension);
  const aiScene* scene = importer.ReadFile(file.string(), aiProcess_ValidateDataStructure);
  if (scene) {
    require_corners(*scene, file);
    scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
  }
  if (!scene || !scene->mRootNode)
    refuse(file, fmt::format("no mesh in it ({})", importer.GetErrorString()), "a mesh");
  return join(*scene, file, settings);
}

}  // namespace

Mesh load_mesh(const fs::path& file, const MeshLoadSettings& settings) {
  require_readable(file, settings);
  const std::string extension = extension_of(file);
  if (std::find(std::begin(kExtensions), std::end(kExtensions), extension) == std::end(kExtensions))
    refuse(file, "the extension \"" + extension + "\"", "obj, ply, stl, gltf, glb or 3ds");
  const bool is_gltf = extension == "gltf" || extension == "glb";
  const auto read = [&] {
    return is_gltf ? read_gltf_mesh(file, extension, settings) : read_with_assimp(file, extension, settings);
  };
  Mesh mesh = settings.untrusted ? read_mesh_in_child(file.string(), read, settings.max_faces) : read();
  if (mesh.faces.empty()) refuse(file, "no faces", "a mesh");
  return mesh;
}

}  // namespace lodestone
