#include "reference/mesh/gltf_mesh.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "reference/error.h"
#include "reference/mesh/mass_properties.h"
#include "tests/message_of.h"
#include "tests/temporary_folder.h"

namespace lodestone::gltf_mesh_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

template <typename T>
void append_bytes(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

/// A box of 6 m³, its vertices and then its faces as 16-bit indices.
std::string box_bytes() {
  const Mesh box = make_box({1, 2, 3});
  std::string bytes;
  for (const Vec3& vertex : box.vertices)
    for (const double coordinate : vertex) append_bytes(bytes, float(coordinate));
  for (const auto& face : box.faces)
    for (const int i : face) append_bytes(bytes, std::uint16_t(i));
  return bytes;
}

json box_json() {
  return json::parse(
      R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    "buffers": [{"byteLength": 168}],
    "bufferViews": [{"buffer": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 72}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3"},
                  {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}]})");
}

std::string as_glb(std::string text, const std::string& binary) {
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string bytes = "glTF";
  append_bytes(bytes, std::uint32_t(2));
  append_bytes(bytes, std::uint32_t(28 + text.size() + binary.size()));
  append_bytes(bytes, std::uint32_t(text.size()));
  bytes += "JSON" + text;
  append_bytes(bytes, std::uint32_t(binary.size()));
  return bytes + std::string("BIN\0", 4) + binary;
}

class GltfMesh : public ::testing::Test {
 protected:
  Mesh load(const std::string& bytes, const std::string& name = "box.glb") const {
    return load_mesh(folder_.write(name, bytes));
  }

  /// What the error says after the file's name.
  std::string error_of(const std::string& bytes, const std::string& name = "box.glb") const {
    const std::string message = testing::message_of([&] { load(bytes, name); });
    EXPECT_NE(message.find(", expected "), std::string::npos) << message;
    return testing::after_head(message, folder_.at(name).string() + ": found ");
  }

  /// Of the box with `value` at `place`.
  std::string error_with(const std::string& place, const json& value) const {
    json changed = box_json();
    changed[json::json_pointer(place)] = value;
    return error_of(as_glb(changed.dump(), box_bytes()));
  }

  double volume_of(const json& gltf, const std::string& bytes = box_bytes()) const {
    return measure_mass_properties(repair_mesh(load(as_glb(gltf.dump(), bytes)), "box")).volume;
  }

  const testing::TemporaryFolder folder_;
};

TEST_F(GltfMesh, InItsBinaryFormIsRead) {
  EXPECT_NEAR(volume_of(box_json()), 6.0, 1e-6);
  json whole = box_json();
  whole["buffers"][0]["uri"] = "its%20buffer.bin";
  std::ofstream(folder_.path() / "its buffer.bin", std::ios::binary) << box_bytes();
  EXPECT_EQ(load(whole.dump(), "box.gltf").faces.size(), 12u);
}

TEST_F(GltfMesh, WithItsBufferAsTextIsRead) {
  const auto triangle =
      json::parse(R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}], "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}]})");
  const Mesh mesh = load(triangle.dump(), "triangle.gltf");
  ASSERT_EQ(mesh.faces.size(), 1u);
  EXPECT_EQ(mesh.vertices[1], Vec3(1, 0, 0));
  EXPECT_EQ(mesh.vertices[2], Vec3(0, 1, 0));
}

TEST_F(GltfMesh, IsPlacedByItsNodes) {
  json placed = box_json();
  placed["nodes"] = json::parse(
      R"([{"children": [1, 2], "scale": [2, 1, 1]}, {"mesh": 0, "translation": [5, 0, 0], "rotation": [0, 0, 0.7071067811865476, 0.7071067811865476]},
    {"mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 3, 0, 0, 20, 0, 1]}])");
  const Mesh mesh = load(as_glb(placed.dump(), box_bytes()));
  EXPECT_NEAR(measure_mass_properties(repair_mesh(mesh, "two")).volume, 12.0 + 36.0, 1e-5);
  const Vec3 corner = make_box({1, 2, 3}).vertices[0];
  EXPECT_TRUE(mesh.vertices[0].isApprox(Vec3(2 * (5 - corner.y()), corner.x(), corner.z()), 1e-6))
      << mesh.vertices[0].transpose();
  EXPECT_TRUE(mesh.vertices[8].isApprox(Vec3(2 * corner.x(), corner.y() + 20, 3 * corner.z()), 1e-6))
      << mesh.vertices[8].transpose();
}

// glTF 2.0, 3.7.4. Open meshes are not turned right afterwards.
TEST_F(GltfMesh, OfAMirroredNodeFacesOutwardsStill) {
  json mirrored = box_json();
  mirrored["nodes"] = json::parse(R"([{"children": [1], "scale": [-1, 1, 1]}, {"mesh": 0}])");
  EXPECT_NEAR(measure_mass_properties(load(as_glb(mirrored.dump(), box_bytes()))).volume, 6.0, 1e-6);
  mirrored["nodes"][1]["scale"] = {1, -1, 1};  // and back
  EXPECT_NEAR(measure_mass_properties(load(as_glb(mirrored.dump(), box_bytes()))).volume, 6.0, 1e-6);
}

TEST_F(GltfMesh, OfStripsAndFansIsRead) {
  json strip = box_json();
  strip["meshes"][0]["primitives"][0] = {{"attributes", {{"POSITION", 0}}}, {"mode", 5}};
  const Mesh of_strip = load(as_glb(strip.dump(), box_bytes()));
  ASSERT_EQ(of_strip.faces.size(), 6u);
  EXPECT_EQ(of_strip.faces[1], (std::array{1, 3, 2}));
  strip["meshes"][0]["primitives"][0]["mode"] = 6;
  EXPECT_EQ(load(as_glb(strip.dump(), box_bytes())).faces[1], (std::array{2, 3, 0}));
}

TEST_F(GltfMesh, WithSparsePositionsIsRead) {
  // The first two indices of the box's faces, as places; its first two vertices, as values.
  json sparse = box_json();
  sparse["accessors"][0]["sparse"] = json::parse(
      R"({"count": 2, "indices": {"bufferView": 1, "componentType": 5123}, "values": {"bufferView": 0}})");
  const Mesh plain = load(as_glb(box_json().dump(), box_bytes())),
             mesh = load(as_glb(sparse.dump(), box_bytes()));
  EXPECT_EQ(mesh.vertices[std::size_t(plain.faces[0][0])], plain.vertices[0]);
  EXPECT_EQ(mesh.vertices[std::size_t(plain.faces[0][1])], plain.vertices[1]);
}

TEST_F(GltfMesh, ThatPromisesMoreThanItHasIsRefused) {
  EXPECT_NE(error_with("/accessors/0/count", 9).find("9 elements of 12 bytes at 0 in a bufferView of 96"),
            std::string::npos);
  EXPECT_NE(error_with("/accessors/0/count", 4'000'000'000u), "no error");
  EXPECT_NE(error_with("/accessors/0/byteOffset", 4).find("8 elements"), std::string::npos);
  EXPECT_NE(error_with("/accessors/1/byteOffset", 1e15).find("36 elements"), std::string::npos);
  EXPECT_NE(error_with("/bufferViews/1/byteOffset", 97).find("bufferView 1 of 72 bytes at 97"),
            std::string::npos);
  EXPECT_NE(error_with("/bufferViews/0/byteStride", 16).find("8 elements of 12 bytes"), std::string::npos);
  EXPECT_NE(error_with("/bufferViews/0/byteStride", 8).find("byteStride 8"), std::string::npos);
  EXPECT_NE(error_with("/buffers/0/byteLength", 169).find("buffer 0 of 169 bytes"), std::string::npos);
  EXPECT_NE(error_with("/accessors/0/type", "VEC4").find("type VEC4"), std::string::npos);
  EXPECT_NE(error_with("/accessors/0/componentType", 5125).find("no floats"), std::string::npos);
  EXPECT_NE(error_with("/accessors/1/componentType", 5126).find("unsigned integers"), std::string::npos);
  EXPECT_NE(error_with("/accessors/0/count", -1).find("count -1"), std::string::npos);
  EXPECT_NE(error_with("/accessors/0/count", 7).find("index 7"), std::string::npos);
  for (const char* place : {"/nodes/0/mesh", "/scenes/0/nodes/0", "/meshes/0/primitives/0/indices",
                            "/accessors/1/bufferView", "/bufferViews/0/buffer", "/scene"})
    EXPECT_NE(error_with(place, 9), "no error") << place;
  EXPECT_NE(error_with("/nodes/0/children", {0}).find("two places"), std::string::npos);
  const auto sparse = json::parse(
      R"({"count": 10000000, "indices": {"bufferView": 0, "componentType": 5123}, "values": {"bufferView": 1}})");
  EXPECT_NE(error_with("/accessors/1/sparse", sparse).find("10000000 replaced elements of 36"),
            std::string::npos);
  // The box's vertices, as places: beyond its eight.
  const auto beyond = json::parse(
      R"({"count": 2, "indices": {"bufferView": 0, "componentType": 5125}, "values": {"bufferView": 0}})");
  EXPECT_NE(error_with("/accessors/0/sparse", beyond).find("of 8 replaced"), std::string::npos);
}

TEST_F(GltfMesh, OfManyCopiesIsRefused) {
  json many = box_json();
  many["nodes"] = json::array();
  many["scenes"][0]["nodes"] = json::array();
  for (int i = 0; i < 90'000; ++i)
    many["nodes"].push_back({{"mesh", 0}}), many["scenes"][0]["nodes"].push_back(i);
  EXPECT_NE(
      error_of(as_glb(many.dump(), box_bytes())).find("expected at most 1000000 (simplify the mesh first)"),
      std::string::npos);
}

TEST_F(GltfMesh, WithChunksThatDoNotFitIsRefused) {
  const std::string good = as_glb(box_json().dump(), box_bytes());
  const auto with = [&](std::size_t at, std::uint32_t value) {
    std::string bad = good;
    bad.replace(at, 4, reinterpret_cast<const char*>(&value), 4);
    return error_of(bad);
  };
  EXPECT_NE(with(12, 0xfffffff0).find("JSON chunk of 4294967280 bytes"), std::string::npos);
  EXPECT_NE(with(12, 0xd6000228).find("JSON chunk"), std::string::npos);
  EXPECT_NE(with(8, 0xfffffff0).find("a length of 4294967280"), std::string::npos);
  EXPECT_NE(with(good.size() - 176, 0xfffffff0).find("BIN chunk of 4294967280 bytes"), std::string::npos);
  EXPECT_NE(with(4, 1).find("glTF version 1"), std::string::npos);
  for (std::size_t length = 1; length < good.size(); length += 3)
    EXPECT_NE(error_of(good.substr(0, length)), "no error") << length;
}

TEST_F(GltfMesh, WhoseTextIsNoJsonIsRefused) {
  for (const char* text : {"{", "[1,]", "{\"a\" 1}", "{\"a\": 01x}", "{\"a\": 1e999}", "\"\\", "{} {}", "nul",
                           "{\"asset\": {\"version\": \"2.0}"})
    EXPECT_NE(error_of(text, "bad.gltf").find(" JSON, expected "), std::string::npos) << text;
  EXPECT_NE(error_of(
                "[" + std::string(2'100'000, ' ') + "1" +
                    [] {
                      std::string ones;
                      for (int i = 0; i < 1'000'000; ++i) ones += ",1";
                      return ones;
                    }() +
                    "]",
                "long.gltf")
                .find("more than 1000000 JSON values"),
            std::string::npos);
  EXPECT_NE(error_of(R"({"asset": {"version": "1.0"}})", "old.gltf").find("glTF version \"1.0\""),
            std::string::npos);
  EXPECT_NE(error_of(R"({"asset": {"version": "2.0"}, "extensionsRequired": ["KHR_draco_mesh_compression"]})",
                     "packed.gltf")
                .find("compressed"),
            std::string::npos);
}

}  // namespace
}  // namespace lodestone::gltf_mesh_test
