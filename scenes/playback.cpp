#include "scenes/playback.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>

#include "reference/error.h"
#include "reference/mesh/simplified_shapes.h"
#include "scenes/framing.h"
#include "scenes/terrain.h"
#include "signature/file_bytes.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "the file is little-endian");

constexpr std::array<char, 8> kMagic{'L', 'O', 'D', 'E', 'P', 'L', 'A', 'Y'};
constexpr double kMostFaces = 3e6;       // of all bodies together
constexpr int kLeastFaces = 60;          // of one, where it had more
constexpr double kUnitsOfRadius = 8192;  // positions are kept to this part of the smallest body's radius, or
constexpr double kMostUnits = 2e9;       // more roughly where a body goes farther than so many of that
constexpr int kLastRule = int(Rule::paused);

// The blobs, and their places for the header.
class Blobs {
 public:
  void add(const char* name, std::span<const std::byte> raw) {
    uLongf size = compressBound(uLong(raw.size()));
    const std::size_t offset = bytes_.size();
    bytes_.resize(offset + size);
    const int result = compress2(reinterpret_cast<Bytef*>(bytes_.data() + offset), &size,
                                 reinterpret_cast<const Bytef*>(raw.data()), uLong(raw.size()), 6);
    check_that(result == Z_OK, "room for what is deflated");
    bytes_.resize(offset + size);
    places_[name] = {{"offset", offset}, {"bytes", std::size_t(size)}, {"raw_bytes", raw.size()}};
  }
  const ordered_json& places() const { return places_; }
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  ordered_json places_;
  std::vector<std::byte> bytes_;
};

// Numbers of all bodies over the frames, as differences to what the two frames before let expect, byte planes
// apart.
template <class Unsigned>
class Predicted {
 public:
  explicit Predicted(std::size_t bodies) : last_(bodies), before_last_(bodies), differences_(bodies) {}

  void add_frame(std::span<const Unsigned> values, bool first, std::vector<std::byte>& planes) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      differences_[i] = Unsigned(values[i] - Unsigned(2 * last_[i] - before_last_[i]));
      before_last_[i] = first ? values[i] : last_[i];
      last_[i] = values[i];
    }
    for (std::size_t byte = 0; byte < sizeof(Unsigned); ++byte)
      for (const Unsigned difference : differences_) planes.push_back(std::byte(difference >> (8 * byte)));
  }

 private:
  std::vector<Unsigned> last_, before_last_, differences_;
};

std::vector<std::byte> encode_poses(const Trajectory& trajectory, double unit_m) {
  const auto bodies = std::size_t(trajectory.bodies());
  std::vector<std::byte> planes;
  planes.reserve(std::size_t(trajectory.frames()) * bodies * 20);
  std::vector<Predicted<std::uint32_t>> positions(3, Predicted<std::uint32_t>(bodies));
  std::vector<Predicted<std::uint16_t>> orientations(4, Predicted<std::uint16_t>(bodies));
  std::vector<std::uint32_t> lengths(bodies);
  std::vector<std::uint16_t> parts(bodies);
  for (int frame = 0; frame < trajectory.frames(); ++frame) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t body = 0; body < bodies; ++body) {
        const double units = double(trajectory.position(frame, int(body))[axis]) / unit_m;
        lengths[body] = std::uint32_t(std::int32_t(std::lround(std::clamp(units, -kMostUnits, kMostUnits))));
      }
      positions[axis].add_frame(lengths, frame == 0, planes);
    }
    for (std::size_t part = 0; part < 4; ++part) {
      for (std::size_t body = 0; body < bodies; ++body)
        parts[body] = std::uint16_t(trajectory.orientation(frame, int(body))[part]);
      orientations[part].add_frame(parts, frame == 0, planes);
    }
  }
  return planes;
}

// A byte of each body and frame, xor that of the frame before.
template <class Function>
std::vector<std::byte> encode_bytes(const Trajectory& trajectory, const Function& byte_of) {
  std::vector<std::byte> bytes;
  bytes.reserve(std::size_t(trajectory.frames()) * std::size_t(trajectory.bodies()));
  for (int frame = 0; frame < trajectory.frames(); ++frame)
    for (int body = 0; body < trajectory.bodies(); ++body) {
      const std::uint8_t now = byte_of(frame, body),
                         before = frame > 0 ? byte_of(frame - 1, body) : std::uint8_t(0);
      bytes.push_back(std::byte(now ^ before));
    }
  return bytes;
}

std::uint8_t status_byte(const BodyStatus& status) {
  return std::uint8_t(int(status.rung) + 4 * int(status.asleep) + 8 * int(status.rule));
}
static_assert(kLastRule < 32, "a rule has five bits");

// Meshes one after the other.
class Meshes {
 public:
  ordered_json add(const Mesh& mesh) {
    const ordered_json place{{"first_vertex", vertices_.size() / 3},
                             {"vertices", mesh.vertices.size()},
                             {"first_face", corners_.size() / 3},
                             {"faces", mesh.faces.size()}};
    for (const Vec3& v : mesh.vertices)
      for (const double x : v) vertices_.push_back(float(x));
    for (const std::array<int, 3>& face : mesh.faces)
      for (const int corner : face) corners_.push_back(std::uint32_t(corner));
    return place;
  }
  std::vector<std::byte> bytes() const {
    std::vector<std::byte> bytes(std::as_bytes(std::span(vertices_)).begin(),
                                 std::as_bytes(std::span(vertices_)).end());
    bytes.insert(bytes.end(), std::as_bytes(std::span(corners_)).begin(),
                 std::as_bytes(std::span(corners_)).end());
    return bytes;
  }
  std::size_t vertices() const { return vertices_.size() / 3; }
  std::size_t faces() const { return corners_.size() / 3; }

 private:
  std::vector<float> vertices_;
  std::vector<std::uint32_t> corners_;
};

// As few faces as `faces`, if they can be had: a mesh that cannot be simplified so far stays as it is.
Mesh drawn_mesh(const Mesh& mesh, int faces) {
  if (int(mesh.faces.size()) <= faces) return mesh;
  try {
    return simplify_mesh(mesh, faces);
  } catch (const InputError&) {
    return mesh;
  }
}

Mesh hull_mesh(const Shape& shape) { return {shape.hull.vertices, shape.hull.faces}; }

// To five decimals, which keeps the header short.
template <class Values>
std::vector<double> rounded(const Values& values) {
  std::vector<double> result;
  for (const double value : values) result.push_back(std::round(1e5 * value) / 1e5);
  return result;
}

/// m, along an axis, of any body at any time.
double farthest_coordinate(const Trajectory& trajectory) {
  double farthest = 0.0;
  for (int frame = 0; frame < trajectory.frames(); ++frame)
    for (int body = 0; body < trajectory.bodies(); ++body)
      for (const double at : trajectory.position(frame, body))
        if (std::isfinite(at)) farthest = std::max(farthest, std::abs(double(at)));
  return farthest;
}

std::vector<double> numbers(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

class Header {
 public:
  Header(const Trajectory& trajectory, const Scene& scene, const PlaybackTitle& title, Meshes& meshes)
      : trajectory_(trajectory),
        scene_(scene),
        meshes_(meshes),
        farthest_m_(farthest_coordinate(trajectory)) {
    json_["version"] = kPlaybackVersion;
    json_["label"] = title.label;
    json_["from_step"] = title.from_step;
    json_["scene"] = scene.file.filename().string();
    json_["dt_s"] = title.dt_s;
    json_["unit_m"] = unit_m();
    json_["bodies"] = trajectory.bodies();
    json_["times_s"] = rounded(trajectory.times_s());
    json_["step_ms"] = rounded(title.step_ms);
    add_rules();
    add_shapes();
    add_names();
    add_ground();
    add_viewpoints();
  }
  ordered_json& json() { return json_; }
  double unit_m() const {
    double smallest = 1e9;
    for (const SceneBody& body : scene_.bodies) smallest = std::min(smallest, body.definition.shape->radius);
    return scene_.bodies.empty() ? 1e-4 : std::max(smallest / kUnitsOfRadius, farthest_m_ / kMostUnits);
  }

 private:
  void add_rules() {
    json_["rules"] = ordered_json::array();
    for (int rule = 0; rule <= kLastRule; ++rule) json_["rules"].push_back(text_of(Rule(rule)));
  }

  void add_shapes() {
    std::map<const Shape*, int> index;
    std::vector<int> shape_of;
    json_["shapes"] = ordered_json::array();
    const int faces = std::max(kLeastFaces, int(kMostFaces / std::max<std::size_t>(1, scene_.bodies.size())));
    for (const SceneBody& body : scene_.bodies) {
      const Shape& shape = *body.definition.shape;
      const auto [known, is_new] = index.emplace(&shape, int(index.size()));
      if (is_new)
        json_["shapes"].push_back({{"name", shape.name},
                                   {"radius_m", shape.radius},
                                   {"mesh", meshes_.add(drawn_mesh(shape.mesh, faces))},
                                   {"hull", meshes_.add(drawn_mesh(hull_mesh(shape), 200))}});
      shape_of.push_back(known->second);
    }
    json_["shape_of"] = shape_of;
  }

  void add_names() {
    json_["names"] = ordered_json::object();
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i)
      if (!scene_.bodies[i].name.empty()) json_["names"][std::to_string(i)] = scene_.bodies[i].name;
  }

  void add_ground() {
    json_["ground"] = ordered_json::array();
    for (const SceneGround& ground : scene_.ground) {
      if (const auto* plane = std::get_if<GroundPlane>(&ground))
        json_["ground"].push_back(
            {{"plane", {{"normal", numbers(plane->normal)}, {"offset_m", plane->offset_m}}}});
      else
        json_["ground"].push_back({{"mesh", meshes_.add(mesh_of(ground))}});
    }
  }

  static Mesh mesh_of(const SceneGround& ground) {
    const auto* given = std::get_if<GroundMesh>(&ground);
    return given ? given->mesh : make_ground_mesh(std::get<GroundBox>(ground));
  }

  void add_viewpoints() {
    std::vector<SceneViewpoint> viewpoints = scene_.viewpoints;
    json_["has_viewpoint"] = !viewpoints.empty();
    if (viewpoints.empty()) viewpoints = {frame_bodies(trajectory_, scene_)};
    json_["viewpoints"] = ordered_json::array();
    for (const SceneViewpoint& viewpoint : viewpoints) {
      ordered_json path = ordered_json::array();
      for (const SceneViewpoint::Key& key : viewpoint.path)
        path.push_back({{"time_s", key.time_s}, {"position_m", numbers(key.position_m)}});
      json_["viewpoints"].push_back({{"position_m", numbers(viewpoint.position_at(0))},
                                     {"look_at_m", numbers(viewpoint.look_at_m)},
                                     {"path", path}});
    }
  }

  const Trajectory& trajectory_;
  const Scene& scene_;
  Meshes& meshes_;
  double farthest_m_;
  ordered_json json_;
};

template <class Values>
void append(std::vector<std::byte>& bytes, const Values& values) {
  const auto added = std::as_bytes(std::span(values));
  bytes.insert(bytes.end(), added.begin(), added.end());
}

}  // namespace

void save_playback(const fs::path& file, const Trajectory& trajectory, const Scene& scene,
                   const PlaybackTitle& title) {
  check_that(trajectory.bodies() == int(scene.bodies.size()), "a trajectory of this scene");
  Meshes meshes;
  Header header(trajectory, scene, title, meshes);
  Blobs blobs;
  blobs.add("poses", encode_poses(trajectory, header.unit_m()));
  blobs.add("status", encode_bytes(trajectory, [&](int frame, int body) {
              return status_byte(trajectory.status(frame, body));
            }));
  blobs.add("spheres", encode_bytes(trajectory, [&](int frame, int body) {
              const double share = double(trajectory.status(frame, body).collision_radius_m) /
                                   scene.bodies[std::size_t(body)].definition.shape->radius;
              return std::uint8_t(std::clamp(std::lround(255 * share), 0L, 255L));
            }));
  blobs.add("meshes", meshes.bytes());
  header.json()["mesh_vertices"] = meshes.vertices();
  header.json()["mesh_faces"] = meshes.faces();
  header.json()["blobs"] = blobs.places();
  const std::string text = header.json().dump(-1, ' ', false, ordered_json::error_handler_t::replace);
  const std::array<std::uint32_t, 2> sizes{std::uint32_t(kPlaybackVersion), std::uint32_t(text.size())};
  std::vector<std::byte> bytes;
  append(bytes, kMagic);
  append(bytes, sizes);
  append(bytes, text);
  append(bytes, blobs.bytes());
  write_atomically(bytes, file);
}

Playback load_playback(const fs::path& file) {
  const MappedFile mapped(file, "a recorded run");
  const std::span<const std::byte> bytes = mapped.bytes();
  const auto fail = [&](const std::string& found) {
    throw InputError(fmt::format("{}: found {}, expected what `lodestone run SCENE --out DIR` writes",
                                 file.string(), found));
  };
  std::array<std::uint32_t, 2> sizes{};
  const std::size_t head = kMagic.size() + sizeof(sizes);
  if (bytes.size() < head || std::memcmp(bytes.data(), kMagic.data(), kMagic.size()) != 0)
    fail("no playback file");
  std::memcpy(sizes.data(), bytes.data() + kMagic.size(), sizeof(sizes));
  if (sizes[0] != std::uint32_t(kPlaybackVersion))
    fail(fmt::format("a playback file of version {}, not {}", sizes[0], kPlaybackVersion));
  if (bytes.size() - head < sizes[1]) fail("a playback file cut short");
  Playback playback;
  const char* text = reinterpret_cast<const char*>(bytes.data() + head);
  playback.header = ordered_json::parse(text, text + sizes[1], nullptr, false);
  const auto& header = playback.header;
  const bool has_label = header.is_object() && header.contains("label") && header["label"].is_string();
  if (!has_label || !header.contains("blobs") || !header["blobs"].is_object())
    fail("a damaged playback file");
  playback.blobs.assign(bytes.begin() + std::ptrdiff_t(head + sizes[1]), bytes.end());
  for (const auto& blob : playback.header["blobs"].items()) {
    const auto number = [&](const char* key) {
      const auto& place = blob.value();
      if (!place.is_object() || !place.contains(key) || !place[key].is_number_unsigned())
        fail(fmt::format("a damaged playback file: no {} of {}", key, blob.key()));
      return place[key].get<std::size_t>();
    };
    const std::size_t offset = number("offset"), size = number("bytes"), held = playback.blobs.size();
    if (offset > held || size > held - offset) fail("a playback file cut short");
  }
  return playback;
}

}  // namespace lodestone
