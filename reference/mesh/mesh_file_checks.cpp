#include "reference/mesh/mesh_file_checks.h"

#include <fmt/format.h>

#include <cstdint>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string_view>

#include "reference/error.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxHeaderLines = 1000;  // of a PLY file
constexpr int kMaxJsonDepth = 64;
constexpr int kMaxParents = 1000;  // glTF nodes with children: a bound on the depth of their tree

[[noreturn]] void refuse(const fs::path& file, const std::string& found, const std::string& expected) {
  throw InputError(fmt::format("{}: found {}, expected {}", file.string(), found, expected));
}

/// Assimp looks for `end_header` for ever, and sets aside room for all elements before it reads the first.
void check_ply_header(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const double bytes = double(fs::file_size(file));
  double promised = 0.0;
  std::string line;
  for (int i = 0; i < kMaxHeaderLines && std::getline(stream, line); ++i) {
    std::istringstream words(line);
    std::string keyword, name;
    double count = 0.0;
    words >> keyword;
    if (keyword == "end_header") return;
    if (keyword != "element") continue;
    if (words >> name >> count) promised += count;
    if (!words || !(count >= 0.0) || promised > bytes)
      refuse(file, fmt::format("\"{}\" in a file of {} bytes", line, bytes), "a count of elements that fits");
  }
  refuse(file, "a header without end_header", "a PLY header");
}

/// The JSON text of a .gltf file, or of a .glb file's first chunk.
std::string read_json(const fs::path& file, const std::string& extension) {
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  if (extension == "gltf" || bytes.size() < 20) return bytes;
  std::size_t length = 0;  // little-endian, after magic, version and total length
  for (int i = 3; i >= 0; --i) length = length << 8 | std::uint8_t(bytes[12 + i]);
  return bytes.substr(20, length);
}

int measure_depth(std::string_view json) {
  int depth = 0, deepest = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (in_string && c == '\\')
      ++i;
    else if (c == '"')
      in_string = !in_string;
    else if (!in_string && (c == '[' || c == '{'))
      deepest = std::max(deepest, ++depth);
    else if (!in_string && (c == ']' || c == '}'))
      --depth;
  }
  return deepest;
}

/// Assimp recurses into the JSON and into the tree of nodes.
void check_gltf_depth(const fs::path& file, const std::string& extension) {
  const std::string json = read_json(file, extension);
  if (const int depth = measure_depth(json); depth > kMaxJsonDepth)
    refuse(file, fmt::format("JSON nested {} deep", depth), fmt::format("at most {}", kMaxJsonDepth));
  int parents = 0;
  for (auto place = json.find("\"children\""); place != std::string::npos;
       place = json.find("\"children\"", place + 1))
    ++parents;
  if (parents > kMaxParents)
    refuse(file, fmt::format("{} nodes with children", parents), fmt::format("at most {}", kMaxParents));
}

}  // namespace

void require_safe_for_assimp(const fs::path& file, const std::string& extension) {
  if (extension == "ply") check_ply_header(file);
  if (extension == "gltf" || extension == "glb") check_gltf_depth(file, extension);
}

}  // namespace lodestone
