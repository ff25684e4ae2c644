#include "reference/mesh/gltf_mesh.h"

#include <fmt/format.h>

#include <array>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <string_view>

#include "reference/error.h"
#include "reference/mesh/json_value.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little, "numbers are copied from the file as they are");

// Nodes with children: more is no model but a trap for readers that recurse.
constexpr int kMaxParents = 1000;
constexpr std::uint64_t kMaxCount = std::uint64_t(1) << 53;  // integers that a double holds
enum : int {
  kByte = 5120,
  kUnsignedByte,
  kShort,
  kUnsignedShort,
  kUnsignedInt = 5125,
  kFloat
};                                                            // componentType
enum : int { kTriangles = 4, kTriangleStrip, kTriangleFan };  // mode

[[noreturn]] void fail(const std::string& found, const std::string& expected) {
  throw InputError(fmt::format("found {}, expected {}", found, expected));
}

std::string read_bytes(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) fail(fmt::format("{} that cannot be read", file.filename().string()), "its bytes");
  return bytes;
}

template <class T>
T number_at(std::string_view bytes, std::size_t at) {
  T number;
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

std::string decode_base64(std::string_view text) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3);
  unsigned bits = 0, held = 0;
  for (const char c : text.substr(0, text.find_last_not_of('=') + 1)) {
    const std::size_t digit = kDigits.find(c);
    if (digit == kDigits.npos) fail("a buffer whose base64 has other characters", "base64");
    bits = bits << 6 | unsigned(digit);
    held += 6;
    if (held < 8) continue;
    held -= 8;
    bytes += char(bits >> held & 0xff);
  }
  return bytes;
}

/// Of a URI: %20 is a space.
std::string decode_percents(std::string_view uri) {
  std::string name;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    unsigned code = 0;
    const bool is_code = uri[i] == '%' && i + 2 < uri.size() && std::isxdigit(std::uint8_t(uri[i + 1])) &&
                         std::isxdigit(std::uint8_t(uri[i + 2]));
    if (is_code) code = unsigned(std::stoul(std::string(uri.substr(i + 1, 2)), nullptr, 16));
    name += is_code ? char(code) : uri[i];
    if (is_code) i += 2;
  }
  return name;
}

/// The two chunks of a .glb file (section 4.4 of the specification).
struct Chunks {
  std::string_view json;
  std::optional<std::string_view> binary;
};

Chunks split_chunks(std::string_view bytes) {
  if (bytes.size() < 20 || bytes.substr(0, 4) != "glTF") fail("no glTF header", "a binary glTF file");
  if (const auto version = number_at<std::uint32_t>(bytes, 4); version != 2)
    fail(fmt::format("glTF version {}", version), "2");
  const std::uint64_t length = number_at<std::uint32_t>(bytes, 8);
  if (length < 20 || length > bytes.size())
    fail(fmt::format("a length of {} in a file of {} bytes", length, bytes.size()), "the file's");
  Chunks chunks;
  const auto chunk_at = [&](std::uint64_t at, std::string_view type) {
    const std::uint64_t chunk_length = number_at<std::uint32_t>(bytes, at), rest = length - at - 8;
    if (chunk_length > rest)
      fail(fmt::format("a {} chunk of {} bytes where {} are left", type, chunk_length, rest),
           "one that fits");
    return bytes.substr(at + 8, chunk_length);
  };
  if (bytes.substr(16, 4) != "JSON") fail("no JSON chunk", "it first");
  chunks.json = chunk_at(12, "JSON");
  const std::uint64_t next = 20 + chunks.json.size();
  if (next + 8 <= length && bytes.substr(next + 4, 4) == std::string_view("BIN\0", 4))
    chunks.binary = chunk_at(next, "BIN");
  return chunks;
}

/// `key` of `object` as an integer of 0 … `most`; `fallback` where it is missing.
std::uint64_t integer_of(const JsonValue& object, std::string_view key, std::optional<std::uint64_t> fallback,
                         std::uint64_t most = kMaxCount) {
  const JsonValue* value = object.find(key);
  if (!value && fallback) return *fallback;
  if (!value) fail(fmt::format("no {}", key), "it given");
  if (value->kind != JsonValue::Kind::number || !(value->number >= 0.0 && value->number <= double(most)) ||
      value->number != std::floor(value->number))
    fail(fmt::format(
             "{} {}", key,
             value->kind == JsonValue::Kind::number ? fmt::to_string(value->number) : "that is no number"),
         fmt::format("an integer of 0 … {}", most));
  return std::uint64_t(value->number);
}

template <int N>
std::optional<Eigen::Matrix<double, N, 1>> numbers_of(const JsonValue& object, std::string_view key) {
  const JsonValue* list = object.find(key);
  if (!list) return std::nullopt;
  if (list->items.size() != N || list->kind != JsonValue::Kind::list)
    fail(fmt::format("{} with {} numbers", key, list->items.size()), fmt::to_string(N));
  Eigen::Matrix<double, N, 1> numbers;
  for (int i = 0; i < N; ++i) {
    if (list->items[std::size_t(i)].kind != JsonValue::Kind::number)
      fail(fmt::format("{} with what is no number", key), "numbers");
    numbers[i] = list->items[std::size_t(i)].number;
  }
  return numbers;
}

/// The children of `object` under `key`; none where it is missing.
std::span<const JsonValue> list_of(const JsonValue& object, std::string_view key) {
  const JsonValue* list = object.find(key);
  return list && list->kind == JsonValue::Kind::list ? std::span(list->items) : std::span<const JsonValue>();
}

std::size_t size_of_component(std::uint64_t type) {
  switch (type) {
    case kByte:
    case kUnsignedByte:
      return 1;
    case kShort:
    case kUnsignedShort:
      return 2;
    case kUnsignedInt:
    case kFloat:
      return 4;
    default:
      fail(fmt::format("componentType {}", type), "5120, 5121, 5122, 5123, 5125 or 5126");
  }
}

/// Elements at `stride` apart.
struct Elements {
  std::string_view bytes;
  std::size_t stride = 0, count = 0;
  std::uint64_t component = 0;
  std::string_view at(std::size_t i, std::size_t size) const { return bytes.substr(i * stride, size); }
};

std::uint32_t index_in(std::string_view element, std::uint64_t component) {
  if (component == kUnsignedByte) return std::uint8_t(element[0]);
  if (component == kUnsignedShort) return number_at<std::uint16_t>(element, 0);
  return number_at<std::uint32_t>(element, 0);
}

class GltfReader {
 public:
  GltfReader(const fs::path& file, const std::string& extension, const MeshLoadSettings& settings)
      : file_(file), settings_(settings), bytes_(read_bytes(file)) {
    Chunks chunks{.json = bytes_, .binary = {}};
    if (extension == "glb") chunks = split_chunks(bytes_);
    binary_ = chunks.binary;
    root_ = parse_json(chunks.json);
  }

  Mesh read() {
    check_asset();
    check_tree();
    load_buffers();
    place_scene();
    check_counts();
    for (const Placed& placed : placed_) append(placed);
    return std::move(mesh_);
  }

 private:
  struct Placed {
    const JsonValue* primitive;
    Eigen::Matrix4d transform;
  };

  void check_asset() const {
    const JsonValue* asset = root_.find("asset");
    const JsonValue* version = asset ? asset->find("version") : nullptr;
    if (!version) fail("no asset version", "glTF 2.0");
    if (!version->text.starts_with("2."))
      fail(fmt::format("glTF version \"{}\"", version->text.substr(0, 20)), "2.0");
    for (const JsonValue& extension : list_of(root_, "extensionsRequired"))
      if (extension.text == "KHR_draco_mesh_compression" || extension.text == "EXT_meshopt_compression")
        fail(fmt::format("a mesh compressed with {}", extension.text), "an uncompressed one");
  }

  void check_tree() const {
    int parents = 0;
    for (const JsonValue& node : list_of(root_, "nodes")) parents += node.find("children") != nullptr;
    if (parents > kMaxParents)
      fail(fmt::format("{} nodes with children", parents), fmt::format("at most {}", kMaxParents));
  }

  void load_buffers() {
    const std::span<const JsonValue> buffers = list_of(root_, "buffers");
    std::uintmax_t all = 0;
    for (std::size_t i = 0; i < buffers.size(); ++i) {
      const std::uint64_t length = integer_of(buffers[i], "byteLength", {});
      const JsonValue* uri = buffers[i].find("uri");
      if (!uri && !(i == 0 && binary_))
        fail(fmt::format("buffer {} without its bytes", i), "a uri or a BIN chunk");
      owned_.push_back(uri ? load_uri(*uri) : std::string());
      const std::string_view bytes = uri ? std::string_view(owned_.back()) : *binary_;
      if (length > bytes.size())
        fail(fmt::format("buffer {} of {} bytes where there are {}", i, length, bytes.size()),
             "one that fits");
      lengths_.push_back(length);
      if (all += bytes.size(); all > settings_.max_bytes)
        fail(fmt::format("{} bytes of buffers", all), fmt::format("at most {}", settings_.max_bytes));
    }
  }

  std::string_view buffer(std::size_t i) const {
    return (list_of(root_, "buffers")[i].find("uri") ? std::string_view(owned_[i]) : *binary_)
        .substr(0, lengths_[i]);
  }

  /// Data in the file itself, or a file of its own folder.
  std::string load_uri(const JsonValue& value) const {
    const std::string uri = unescape_json(value.text);
    if (uri.starts_with("data:")) {
      const std::size_t comma = uri.find(";base64,");
      if (comma == uri.npos) fail("a data uri of another kind", "base64");
      return decode_base64(std::string_view(uri).substr(comma + 8));
    }
    std::error_code error;
    const fs::path folder = fs::canonical(file_).parent_path();
    const fs::path path = fs::canonical(folder / decode_percents(uri), error);
    if (error || !fs::is_regular_file(path, error) || path.parent_path() != folder)
      fail(fmt::format("buffer \"{}\"", uri.substr(0, 200)), "a file in the same folder");
    if (const auto size = fs::file_size(path, error); error || size > settings_.max_bytes)
      fail(fmt::format("{} bytes in {}", size, path.filename().string()),
           fmt::format("at most {}", settings_.max_bytes));
    return read_bytes(path);
  }

  /// The nodes of the scene, without recursion; each may be reached once (3.5.2: a strict tree).
  void place_scene() {
    const std::span<const JsonValue> scenes = list_of(root_, "scenes"), nodes = list_of(root_, "nodes");
    if (scenes.empty()) fail("no scene", "a mesh in one");
    const JsonValue& scene = scenes[integer_of(root_, "scene", 0, scenes.size() - 1)];
    std::vector<std::pair<std::size_t, Eigen::Matrix4d>> open;
    std::vector<bool> reached(nodes.size(), false);
    const auto push = [&](const JsonValue& object, std::string_view key, const Eigen::Matrix4d& above) {
      const std::span<const JsonValue> children = list_of(object, key);
      for (std::size_t i = children.size(); i-- > 0;) {
        const double child = children[i].number;
        if (children[i].kind != JsonValue::Kind::number || !(child >= 0.0 && child < double(nodes.size())) ||
            child != std::floor(child))
          fail(fmt::format("node {} of {}", child, nodes.size()), "one that there is");
        if (reached[std::size_t(child)]) fail(fmt::format("node {} in two places", child), "a tree");
        reached[std::size_t(child)] = true;
        open.emplace_back(std::size_t(child), above);
      }
    };
    push(scene, "nodes", Eigen::Matrix4d::Identity());
    while (!open.empty()) {
      const auto [index, above] = open.back();
      open.pop_back();
      const Eigen::Matrix4d transform = above * transform_of(nodes[index]);
      place_mesh(nodes[index], transform);
      push(nodes[index], "children", transform);
    }
  }

  static Eigen::Matrix4d transform_of(const JsonValue& node) {
    if (const auto matrix = numbers_of<16>(node, "matrix"))
      return matrix->reshaped(4, 4);  // column by column
    Eigen::Affine3d transform = Eigen::Affine3d::Identity();
    if (const auto translation = numbers_of<3>(node, "translation")) transform.translate(*translation);
    if (const auto q = numbers_of<4>(node, "rotation"))
      transform.rotate(Eigen::Quaterniond(q->w(), q->x(), q->y(), q->z()).toRotationMatrix());
    if (const auto scale = numbers_of<3>(node, "scale")) transform.scale(*scale);
    return transform.matrix();
  }

  void place_mesh(const JsonValue& node, const Eigen::Matrix4d& transform) {
    if (!node.find("mesh")) return;
    const std::span<const JsonValue> meshes = list_of(root_, "meshes");
    if (meshes.empty()) fail("a node with a mesh where there is none", "meshes");
    for (const JsonValue& primitive :
         list_of(meshes[integer_of(node, "mesh", {}, meshes.size() - 1)], "primitives")) {
      if (placed_.size() >= std::size_t(settings_.max_faces))
        fail("too many parts", fmt::format("at most {}", settings_.max_faces));
      if (integer_of(primitive, "mode", kTriangles, kTriangleFan) >= kTriangles && position_of(primitive))
        placed_.push_back({&primitive, transform});
    }
  }

  /// Of the accessor with the positions; null where there are none, as with shapes of extensions.
  static const JsonValue* position_of(const JsonValue& primitive) {
    const JsonValue* attributes = primitive.find("attributes");
    return attributes ? attributes->find("POSITION") : nullptr;
  }

  const JsonValue& accessor(const JsonValue& object, std::string_view key) const {
    const std::span<const JsonValue> accessors = list_of(root_, "accessors");
    if (accessors.empty()) fail("no accessors", fmt::format("that of {}", key));
    return accessors[integer_of(object, key, {}, accessors.size() - 1)];
  }

  std::uint64_t corners_of(const JsonValue& primitive) const {
    return integer_of(primitive.find("indices") ? accessor(primitive, "indices")
                                                : accessor(*primitive.find("attributes"), "POSITION"),
                      "count", {});
  }

  static std::uint64_t faces_of(const JsonValue& primitive, std::uint64_t corners) {
    if (integer_of(primitive, "mode", kTriangles) == kTriangles) return corners / 3;
    return corners < 3 ? 0 : corners - 2;
  }

  /// Before anything is copied: one mesh may be placed many times.
  void check_counts() const {
    const std::uint64_t most = std::uint64_t(settings_.max_faces);
    std::uint64_t faces = 0, vertices = 0;
    for (const Placed& placed : placed_) {
      faces += faces_of(*placed.primitive, corners_of(*placed.primitive));
      vertices += integer_of(accessor(*placed.primitive->find("attributes"), "POSITION"), "count", {});
      if (faces > most)
        fail(fmt::format("{} faces", faces), fmt::format("at most {} (simplify the mesh first)", most));
      if (vertices > 3 * most)
        fail(fmt::format("{} vertices", vertices),
             fmt::format("at most {} (simplify the mesh first)", 3 * most));
    }
  }

  /// `count` elements of `size` bytes in the view that `object` names, from its byteOffset on.
  Elements elements_in_view(const JsonValue& object, std::uint64_t count, std::size_t size,
                            std::uint64_t component) const {
    const std::span<const JsonValue> views = list_of(root_, "bufferViews");
    if (views.empty() || lengths_.empty()) fail("no bufferViews", "what accessors refer to");
    const std::uint64_t index = integer_of(object, "bufferView", {}, views.size() - 1);
    const JsonValue& view = views[index];
    const std::string_view bytes = buffer(integer_of(view, "buffer", {}, lengths_.size() - 1));
    const std::uint64_t offset = integer_of(view, "byteOffset", 0),
                        length = integer_of(view, "byteLength", {});
    if (offset > bytes.size() || length > bytes.size() - offset)
      fail(fmt::format("bufferView {} of {} bytes at {} in a buffer of {}", index, length, offset,
                       bytes.size()),
           "one that fits");
    const std::uint64_t stride = integer_of(view, "byteStride", size, 252),
                        start = integer_of(object, "byteOffset", 0);
    if (stride < size) fail(fmt::format("byteStride {} of elements of {} bytes", stride, size), "no less");
    if (start > length ||
        (count > 0 && (length - start < size || (length - start - size) / stride < count - 1)))
      fail(fmt::format("{} elements of {} bytes at {} in a bufferView of {}", count, size, start, length),
           "as many as fit");
    return {bytes.substr(offset + start, length - start), std::size_t(stride), std::size_t(count), component};
  }

  /// Calls take(i, bytes) for each element, those replaced by a sparse accessor again; zeros have no bytes.
  template <class Take>
  void read_accessor(const JsonValue& accessor, std::string_view type, std::size_t components,
                     const Take& take) const {
    const JsonValue* found = accessor.find("type");
    if (!found || found->text != type)
      fail(fmt::format("an accessor of type {}", found ? found->text : "none"), std::string(type));
    const std::uint64_t component = integer_of(accessor, "componentType", {}),
                        count = integer_of(accessor, "count", {});
    const std::size_t size = components * size_of_component(component);
    if (accessor.find("bufferView")) {
      const Elements all = elements_in_view(accessor, count, size, component);
      for (std::size_t i = 0; i < all.count; ++i) take(i, all.at(i, size));
    }
    const JsonValue* sparse = accessor.find("sparse");
    if (!sparse) return;
    const JsonValue *places = sparse->find("indices"), *values = sparse->find("values");
    if (!places || !values) fail("a sparse accessor without indices or values", "both");
    const std::uint64_t replaced = integer_of(*sparse, "count", {});
    if (replaced > count) fail(fmt::format("{} replaced elements of {}", replaced, count), "no more");
    const std::uint64_t place_type = index_type_of(*places);
    const Elements at = elements_in_view(*places, replaced, size_of_component(place_type), place_type);
    const Elements value = elements_in_view(*values, replaced, size, component);
    for (std::size_t i = 0; i < replaced; ++i) {
      const std::uint32_t place = index_in(at.at(i, size_of_component(place_type)), place_type);
      if (place >= count) fail(fmt::format("element {} of {} replaced", place, count), "one that there is");
      take(place, value.at(i, size));
    }
  }

  static std::uint64_t index_type_of(const JsonValue& object) {
    const std::uint64_t type = integer_of(object, "componentType", {});
    if (type != kUnsignedByte && type != kUnsignedShort && type != kUnsignedInt)
      fail(fmt::format("indices of componentType {}", type), "unsigned integers");
    return type;
  }

  void append(const Placed& placed) {
    const JsonValue& positions = accessor(*placed.primitive->find("attributes"), "POSITION");
    if (integer_of(positions, "componentType", {}) != kFloat)
      fail("positions that are no floats", "floats (KHR_mesh_quantization is not read)");
    const std::size_t first = mesh_.vertices.size(), count = integer_of(positions, "count", {});
    mesh_.vertices.resize(first + count, placed.transform.topRightCorner<3, 1>());
    read_accessor(positions, "VEC3", 3, [&](std::size_t i, std::string_view bytes) {
      const Vec3 local(number_at<float>(bytes, 0), number_at<float>(bytes, 4), number_at<float>(bytes, 8));
      const Vec3 vertex =
          placed.transform.topLeftCorner<3, 3>() * local + placed.transform.topRightCorner<3, 1>();
      if (!vertex.allFinite())
        fail(fmt::format("vertex {} at ({}, {}, {})", i, local.x(), local.y(), local.z()),
             "finite coordinates");
      mesh_.vertices[first + i] = vertex;
    });
    const std::size_t faces = mesh_.faces.size();
    append_faces(*placed.primitive, corner_indices(*placed.primitive, count), int(first));
    if (placed.transform.topLeftCorner<3, 3>().determinant() < 0.0)  // 3.7.4: mirrored, the winding turns
      for (std::size_t i = faces; i < mesh_.faces.size(); ++i)
        std::swap(mesh_.faces[i][1], mesh_.faces[i][2]);
  }

  std::vector<std::uint32_t> corner_indices(const JsonValue& primitive, std::size_t vertices) const {
    std::vector<std::uint32_t> indices(corners_of(primitive));
    if (!primitive.find("indices")) {
      for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = std::uint32_t(i);
      return indices;
    }
    const JsonValue& source = accessor(primitive, "indices");
    const std::uint64_t type = index_type_of(source);
    read_accessor(source, "SCALAR", 1,
                  [&](std::size_t i, std::string_view bytes) { indices[i] = index_in(bytes, type); });
    for (std::size_t i = 0; i < indices.size(); ++i)
      if (indices[i] >= vertices)
        fail(fmt::format("index {} at corner {}", indices[i], i), fmt::format("less than {}", vertices));
    return indices;
  }

  /// 3.7.2.1: in a strip every second triangle is turned; a fan shares its first vertex.
  void append_faces(const JsonValue& primitive, std::span<const std::uint32_t> corners, int first) {
    const std::uint64_t mode = integer_of(primitive, "mode", kTriangles),
                        faces = faces_of(primitive, corners.size());
    const auto vertex = [&](std::uint64_t corner) { return first + int(corners[corner]); };
    for (std::uint64_t i = 0; i < faces; ++i) {
      if (mode == kTriangles) mesh_.faces.push_back({vertex(3 * i), vertex(3 * i + 1), vertex(3 * i + 2)});
      if (mode == kTriangleStrip)
        mesh_.faces.push_back({vertex(i), vertex(i + 1 + i % 2), vertex(i + 2 - i % 2)});
      if (mode == kTriangleFan) mesh_.faces.push_back({vertex(i + 1), vertex(i + 2), vertex(0)});
    }
  }

  const fs::path file_;
  const MeshLoadSettings settings_;
  const std::string bytes_;
  std::optional<std::string_view> binary_;  // the BIN chunk
  JsonValue root_;                          // views into bytes_
  std::vector<std::string> owned_;          // per buffer; empty for the BIN chunk
  std::vector<std::uint64_t> lengths_;      // byteLength per buffer, no more than there are bytes
  std::vector<Placed> placed_;
  Mesh mesh_;
};

}  // namespace

Mesh read_gltf_mesh(const fs::path& file, const std::string& extension, const MeshLoadSettings& settings) {
  try {
    return GltfReader(file, extension, settings).read();
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", file.string(), error.what()));
  }
}

}  // namespace lodestone
