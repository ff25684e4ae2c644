#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "reference/error.h"
#include "reference/mesh/mass_properties.h"
#include "reference/mesh/mesh.h"
#include "reference/random.h"
#include "tests/message_of.h"
#include "tests/temporary_folder.h"

namespace lodestone::mesh_load_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// A folder of this test's own, gone with it; and silence on both streams, checked at the end.
class MeshFile : public ::testing::Test {
 protected:
  MeshFile() {
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
  }
  ~MeshFile() override {
    EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  }

  fs::path write(const std::string& name, const std::string& bytes) const {
    return folder_.write(name, bytes);
  }

  /// What the error says, without the file's name, which must be at its head.
  static std::string error_of(const fs::path& file, const MeshLoadSettings& settings = {}) {
    const std::string message = testing::message_of([&] { load_mesh(file, settings); });
    EXPECT_NE(message.find(", expected "), std::string::npos) << message;
    return testing::after_head(message, file.string() + ": found ");
  }

  /// Of an OBJ file: from the number of the line on.
  static std::string error_in_line(const fs::path& file) {
    return testing::after_head(testing::message_of([&] { load_mesh(file); }), file.string() + ":");
  }

  const testing::TemporaryFolder folder_;
};

void expect_unit_box(const Mesh& loaded, double volume = 1.0) {
  MeshReport report;
  const Mesh mesh = repair_mesh(loaded, "box", &report);
  EXPECT_TRUE(report.closed());
  EXPECT_NEAR(measure_mass_properties(mesh).volume, volume, 1e-6 * volume);
}

std::string as_obj(const Mesh& mesh) {
  std::ostringstream text;
  for (const Vec3& v : mesh.vertices) text << "v " << v.x() << ' ' << v.y() << ' ' << v.z() << '\n';
  for (const auto& [a, b, c] : mesh.faces) text << "f " << a + 1 << ' ' << b + 1 << ' ' << c + 1 << '\n';
  return text.str();
}

std::string as_ply(const Mesh& mesh) {
  std::ostringstream text;
  text << "ply\nformat ascii 1.0\nelement vertex " << mesh.vertices.size()
       << "\nproperty float x\nproperty float y\nproperty float z\nelement face " << mesh.faces.size()
       << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const Vec3& v : mesh.vertices) text << v.x() << ' ' << v.y() << ' ' << v.z() << '\n';
  for (const auto& [a, b, c] : mesh.faces) text << "3 " << a << ' ' << b << ' ' << c << '\n';
  return text.str();
}

template <typename T>
void append_bytes(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

std::string as_stl(const Mesh& mesh) {
  std::string bytes(80, '\0');
  append_bytes(bytes, std::uint32_t(mesh.faces.size()));
  for (const auto& face : mesh.faces) {
    for (int i = 0; i < 3; ++i) append_bytes(bytes, 0.0f);
    for (int i : face)
      for (double coordinate : mesh.vertices[i]) append_bytes(bytes, float(coordinate));
    append_bytes(bytes, std::uint16_t(0));
  }
  return bytes;
}

std::string buffer_of(const Mesh& mesh) {
  std::string bytes;
  for (const Vec3& vertex : mesh.vertices)
    for (double coordinate : vertex) append_bytes(bytes, float(coordinate));
  for (const auto& face : mesh.faces)
    for (int i : face) append_bytes(bytes, std::uint32_t(i));
  return bytes;
}

json as_gltf(const Mesh& mesh, const std::string& uri, const json& nodes = json::parse(R"([{"mesh":0}])")) {
  const std::size_t vertex_bytes = 12 * mesh.vertices.size(), face_bytes = 12 * mesh.faces.size();
  json roots = json::array();
  for (std::size_t i = 0; i < nodes.size(); ++i) roots.push_back(i);
  return {
      {"asset", {{"version", "2.0"}}},
      {"scene", 0},
      {"scenes", {{{"nodes", roots}}}},
      {"nodes", nodes},
      {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}}}}},
      {"buffers", {{{"byteLength", vertex_bytes + face_bytes}, {"uri", uri}}}},
      {"bufferViews",
       {{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", vertex_bytes}},
        {{"buffer", 0}, {"byteOffset", vertex_bytes}, {"byteLength", face_bytes}}}},
      {"accessors",
       {{{"bufferView", 0}, {"componentType", 5126}, {"count", mesh.vertices.size()}, {"type", "VEC3"}},
        {{"bufferView", 1}, {"componentType", 5125}, {"count", 3 * mesh.faces.size()}, {"type", "SCALAR"}}}}};
}

TEST_F(MeshFile, InEachFormatIsRead) {
  const Mesh box = make_box({1, 1, 1});
  expect_unit_box(load_mesh(write("box.obj", as_obj(box))));
  expect_unit_box(load_mesh(write("BOX.OBJ", as_obj(box))));
  expect_unit_box(load_mesh(write("box.ply", as_ply(box))));
  expect_unit_box(load_mesh(write("box.stl", as_stl(box))));
  write("box.bin", buffer_of(box));
  expect_unit_box(load_mesh(write("box.gltf", as_gltf(box, "box.bin").dump())));
  expect_unit_box(load_mesh(write("quads.obj",
                                  "v 0 0 0\nv 0 0 1\nv 0 1 0\nv 0 1 1\nv 1 0 0\nv 1 0 1\nv 1 1 0\nv 1 1 1\n"
                                  "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n")));
}

TEST_F(MeshFile, WithSeveralPlacedMeshesIsJoined) {
  const Mesh box = make_box({1, 1, 1});
  write("box.bin", buffer_of(box));
  const json nodes = {{{"mesh", 0}, {"scale", {2, 2, 2}}}, {{"mesh", 0}, {"translation", {5, 0, 0}}}};
  const Mesh both = load_mesh(write("two.gltf", as_gltf(box, "box.bin", nodes).dump()));
  EXPECT_EQ(both.faces.size(), 24u);
  expect_unit_box(both, 9.0);
}

TEST_F(MeshFile, ThatIsMissingOrNoFileIsRefused) {
  EXPECT_EQ(error_of(folder_.path() / "none.obj").substr(0, 12), "no such file");
  fs::create_directory(folder_.path() / "folder.obj");
  EXPECT_EQ(error_of(folder_.path() / "folder.obj").substr(0, 8), "a folder");
  ASSERT_EQ(mkfifo((folder_.path() / "pipe.obj").c_str(), 0600), 0);
  EXPECT_EQ(error_of(folder_.path() / "pipe.obj").substr(0, 15), "no regular file");
  EXPECT_EQ(error_of(write("empty.obj", "")).substr(0, 13), "an empty file");
  EXPECT_NE(error_of("").find("no such file"), std::string::npos);
}

// Assimp would lose the vertex behind it.
TEST_F(MeshFile, WithAByteOrderMarkBeforeAVertexIsRefused) {
  const std::string mark = "\xef\xbb\xbf", box = as_obj(make_box({1, 1, 1}));
  EXPECT_EQ(error_in_line(write("mark.obj", mark + box)),
            "1: found a byte order mark before 'v', expected a file without it");
  expect_unit_box(load_mesh(write("comment.obj", mark + "# a box\n" + box)));
}

TEST_F(MeshFile, OfAnotherFormatIsRefused) {
  const std::string box = as_obj(make_box({1, 1, 1}));
  for (const char* name : {"box.fbx", "box.dae", "box", "box.", ".obj"})
    EXPECT_NE(error_of(write(name, box)).find("the extension"), std::string::npos);
  for (const char* name : {"box.ply", "box.stl", "box.gltf", "box.glb", "box.3ds"})
    EXPECT_NE(error_of(write(name, box)), "no error") << name;
  RandomStream random(1, 0, 0);
  std::string noise;
  for (int i = 0; i < 3000; ++i) noise.push_back(char(random.uniform(0, 256)));
  for (const char* name : {"n.obj", "n.ply", "n.stl", "n.gltf", "n.glb", "n.3ds"})
    EXPECT_NE(error_of(write(name, noise)), "no error") << name;
}

TEST_F(MeshFile, BeyondALimitIsRefused) {
  const fs::path file = write("sphere.obj", as_obj(make_sphere(1.0, 2)));
  EXPECT_EQ(load_mesh(file, {.max_bytes = fs::file_size(file), .max_faces = 320}).faces.size(), 320u);
  EXPECT_NE(error_of(file, {.max_bytes = fs::file_size(file) - 1}).find("bytes, expected at most"),
            std::string::npos);
  EXPECT_NE(error_of(file, {.max_faces = 319}).find("320 faces"), std::string::npos);
}

TEST_F(MeshFile, WithoutFacesIsRefused) {
  EXPECT_NE(error_of(write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\np 1 2 3\n")).find("no faces"),
            std::string::npos);
  EXPECT_NE(error_of(write("lines.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n")).find("no faces"), std::string::npos);
  EXPECT_NE(error_of(write("words.obj", std::string(500, 'x') + "\n")), "no error");
  EXPECT_NE(
      error_of(write(
          "hollow.ply",
          "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
          "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n0\n")),
      "no error");
}

TEST_F(MeshFile, WithImpossibleNumbersIsRefused) {
  const std::string box = as_obj(make_box({1, 1, 1}));
  for (const char* bad : {"nan", "inf", "-inf", "1e39"})
    EXPECT_EQ(error_in_line(write("bad.obj", box + "v " + std::string(bad) + " 0 0\nf 1 2 3\n")),
              "21: v: found '" + std::string(bad) + "', expected a finite number");
}

TEST_F(MeshFile, WithIndicesOutOfRangeIsRefused) {
  Mesh box = make_box({1, 1, 1});
  for (const char* bad : {"99", "0", "-99"})
    EXPECT_TRUE(error_in_line(write("bad.obj", as_obj(box) + "f 1 2 " + bad + '\n'))
                    .starts_with(std::string("21: f: found vertex ") + bad + ", expected "))
        << bad;
  for (int bad : {8, 99, -1, 1 << 30}) {
    Mesh broken = box;
    broken.faces[3][1] = bad;
    EXPECT_NE(error_of(write("bad.ply", as_ply(broken))), "no error") << bad;
  }
}

TEST_F(MeshFile, ThatPromisesTooMuchIsRefused) {
  // Each of these made assimp 5.2 loop for ever, take all memory, or overflow its stack.
  const std::string box = as_ply(make_box({1, 1, 1}));
  std::string boastful = box, headless = box;
  boastful.replace(boastful.find("vertex 8"), 8, "vertex 1000000000");
  headless.replace(headless.find("end_header"), 10, "end_heaven");
  EXPECT_NE(error_of(write("boastful.ply", boastful)).find("1000000000"), std::string::npos);
  EXPECT_NE(error_of(write("headless.ply", headless)).find("end_header"), std::string::npos);
  EXPECT_NE(error_of(write("deep.gltf", std::string(200'000, '['))).find("nested"), std::string::npos);
  json chain = {{{"mesh", 0}}};
  for (int i = 0; i < 20'000; ++i) chain.push_back({{"children", {i}}});
  json gltf = as_gltf(make_box({1, 1, 1}), "box.bin", chain);
  gltf["scenes"][0]["nodes"] = {20'000};
  EXPECT_NE(error_of(write("chain.gltf", gltf.dump())).find("nodes with children"), std::string::npos);
}

TEST_F(MeshFile, WhoseListsPromiseTooMuchIsRefused) {
  // The first asked assimp 5.2 for 32 GB.
  const std::string box = as_ply(make_box({1, 1, 1}));
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string bad = box;
    bad.replace(bad.find(from), from.size(), to);
    return error_of(write("list.ply", bad));
  };
  const std::string face = "\n3 " + box.substr(box.rfind("\n3 ") + 3);
  EXPECT_NE(with(face, "\n4000000000 0 1 3\n").find("a list of \"4000000000\""), std::string::npos);
  EXPECT_NE(with(face, "\n-3 0 1 3\n").find("a list of \"-3\""), std::string::npos);
  EXPECT_NE(with(face, "\n3 0 1\n"), "no error");
  EXPECT_NE(with(face, "\n"), "no error");
  EXPECT_NE(with("uchar int", "uchar quaternion").find("quaternion"), std::string::npos);
  EXPECT_NE(with("uchar int", "float int").find("fractions"), std::string::npos);
  EXPECT_NE(with("element face", "obj_info x\nelement face").find("obj_info"), std::string::npos);
  std::string binary =
      "ply\nformat binary_little_endian 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty "
      "float z\n"
      "element face 12\nproperty list uint int vertex_indices\nend_header\n";
  const Mesh solid = make_box({1, 1, 1});
  for (const Vec3& vertex : solid.vertices)
    for (const double coordinate : vertex) append_bytes(binary, float(coordinate));
  const std::size_t first = binary.size();
  for (const auto& corners : solid.faces) {
    append_bytes(binary, std::uint32_t(3));
    for (const int i : corners) append_bytes(binary, std::int32_t(i));
  }
  expect_unit_box(load_mesh(write("good.ply", binary)));
  std::string bad = binary;
  bad[first + 3] = char(0xee);
  EXPECT_NE(error_of(write("list.ply", bad)).find("bytes for face 0"), std::string::npos);
  EXPECT_NE(error_of(write("short.ply", binary.substr(0, binary.size() - 1))).find("bytes for face 11"),
            std::string::npos);
}

TEST_F(MeshFile, WhoseTrianglesAreNotThereIsRefused) {
  std::string box = as_stl(make_box({1, 1, 1}));
  box[83] = char(0xee);
  EXPECT_NE(error_of(write("boastful.stl", box)).find("triangles in 684 bytes"), std::string::npos);
}

TEST_F(MeshFile, OpensOnlyItsOwnFolder) {
  const Mesh box = make_box({1, 1, 1});
  fs::create_directory(folder_.path() / "inner");
  write("outside.bin", buffer_of(box));
  EXPECT_NE(error_of(write("inner/box.gltf", as_gltf(box, "../outside.bin").dump())), "no error");
  EXPECT_NE(error_of(write("box.gltf", as_gltf(box, "/dev/zero").dump())), "no error");
  expect_unit_box(load_mesh(write("box.obj", "mtllib /dev/zero\nmtllib none.mtl\nusemtl a\n" + as_obj(box))));
}

TEST_F(MeshFile, CutShortIsNeverReadPastItsEnd) {
  const Mesh box = make_box({1, 1, 1});
  const auto try_to_load = [](const fs::path& file) {
    try {
      for (const auto& face : load_mesh(file).faces)
        for (int i : face) EXPECT_GE(i, 0);
    } catch (const InputError&) {
    }
  };
  for (const auto& [name, bytes] : {std::pair("cut.ply", as_ply(box)), std::pair("cut.stl", as_stl(box)),
                                    std::pair("cut.obj", as_obj(box))})
    for (std::size_t length = 1; length < bytes.size(); length += 7)
      try_to_load(write(name, bytes.substr(0, length)));
}

}  // namespace
}  // namespace lodestone::mesh_load_test
