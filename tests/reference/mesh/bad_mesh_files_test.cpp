// Each class of bad mesh, as a file: mended and reported where that is safe, else refused with an error that
// names the defect and its count.
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <clocale>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string_view>

#include "reference/error.h"
#include "reference/shape.h"
#include "tests/message_of.h"
#include "tests/temporary_folder.h"

namespace lodestone::bad_mesh_files_test {
namespace {

namespace fs = std::filesystem;

class BadMeshFile : public ::testing::Test {
 protected:
  /// As a user's file: written, then loaded and made a shape of.
  Shape make(const std::string& bytes, const MassOverride& mass = {}, const std::string& name = "thing.obj") {
    const fs::path file = write(name, bytes);
    return make_shape(file.string(), load_mesh(file), mass, &report_);
  }

  /// What the error says after the file's name, which must be at its head.
  std::string error_of(const std::string& bytes, const MassOverride& mass = {},
                       const std::string& name = "thing.obj") {
    return testing::after_head(testing::message_of([&] { make(bytes, mass, name); }),
                               folder_.at(name).string() + ": found ");
  }

  /// Of an OBJ file: from the number of the line on.
  std::string error_in_line(const std::string& bytes) {
    return testing::after_head(testing::message_of([&] { make(bytes); }),
                               folder_.at("thing.obj").string() + ":");
  }

  fs::path write(const std::string& name, const std::string& bytes) const {
    return folder_.write(name, bytes);
  }

  const testing::TemporaryFolder folder_;
  MeshReport report_;
};

std::string as_obj(const Mesh& mesh, double scale = 1.0) {
  std::ostringstream text;
  text.precision(9);
  for (const Vec3& v : mesh.vertices)
    text << "v " << scale * v.x() << ' ' << scale * v.y() << ' ' << scale * v.z() << '\n';
  for (const auto& [a, b, c] : mesh.faces) text << "f " << a + 1 << ' ' << b + 1 << ' ' << c + 1 << '\n';
  return text.str();
}

/// Binary: every face has corners of its own.
std::string as_stl(std::span<const std::array<Vec3, 3>> triangles) {
  const auto append = [](std::string& bytes, auto value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  std::string bytes(80, '\0');
  append(bytes, std::uint32_t(triangles.size()));
  for (const auto& triangle : triangles) {
    for (int i = 0; i < 3; ++i) append(bytes, 0.0f);
    for (const Vec3& corner : triangle)
      for (const double coordinate : corner) append(bytes, float(coordinate));
    append(bytes, std::uint16_t(0));
  }
  return bytes;
}

const Mesh kBox = make_box({1, 2, 3});
const MassOverride kGivenMass{.center_of_mass_m = Vec3::Zero(),
                              .inertia_per_mass_m2 = Mat3(Mat3::Identity())};

TEST_F(BadMeshFile, Empty) {
  EXPECT_EQ(error_of("").substr(0, 13), "an empty file");
  EXPECT_EQ(error_of("# nothing\n").substr(0, 15), "no mesh in it (");
  EXPECT_EQ(error_of("v 0 0 0\nv 1 0 0\nv 0 1 0\n").substr(0, 15), "no mesh in it (");
}

TEST_F(BadMeshFile, OneTriangle) {
  EXPECT_EQ(error_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), "1 faces, expected at least 4");
  EXPECT_EQ(error_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", kGivenMass), "1 faces, expected at least 4");
}

TEST_F(BadMeshFile, OpenNeedsItsMassGiven) {
  Mesh open = kBox;
  open.faces.resize(open.faces.size() - 2);
  EXPECT_EQ(error_of(as_obj(open)).substr(0, 39), "4 open edges (with one face only), expe");
  const Shape shape = make(as_obj(open), kGivenMass);
  EXPECT_EQ(report_.open_edges, 4);
  EXPECT_EQ(shape.inertia_per_mass, Mat3::Identity());
}

TEST_F(BadMeshFile, FlippedIsTurned) {
  Mesh flipped = kBox;
  for (int i : {0, 3, 4, 7, 11}) std::swap(flipped.faces[i][0], flipped.faces[i][1]);
  EXPECT_NEAR(make(as_obj(flipped)).volume, 6.0, 1e-6);
  EXPECT_EQ(report_.faces_flipped, 5);
  for (auto& face : flipped.faces = kBox.faces) std::swap(face[0], face[1]);
  EXPECT_NEAR(make(as_obj(flipped)).volume, 6.0, 1e-6);
  EXPECT_EQ(report_.faces_flipped, 12);
}

TEST_F(BadMeshFile, NonManifold) {
  // Two boxes that share one edge and nothing else.
  Mesh both = kBox;
  for (const Vec3& vertex : kBox.vertices) both.vertices.push_back(vertex + Vec3(1, 2, 0));
  for (const auto& [a, b, c] : kBox.faces) both.faces.push_back({a + 8, b + 8, c + 8});
  EXPECT_EQ(error_of(as_obj(both)).substr(0, 41), "1 non-manifold edges (with more than two ");
  make(as_obj(both), kGivenMass);
  EXPECT_EQ(report_.non_manifold_edges, 1);
}

TEST_F(BadMeshFile, FacesWithoutAreaAreDropped) {
  const std::string extra = "v 0.1 0 0\nv 0.2 0 0\nv 0.3 0 0\nf 9 10 11\nf 1 1 2\nf 3 3 3\n";
  EXPECT_NEAR(make(as_obj(kBox) + extra).volume, 6.0, 1e-6);
  EXPECT_EQ(report_.degenerate_faces_dropped, 3);
  EXPECT_EQ(error_of("v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nf 1 2 3\nf 2 3 4\nf 1 2 4\nf 1 3 4\n"),
            "0 faces, beside 4 without area, expected at least 4");
}

TEST_F(BadMeshFile, DuplicatesAndUnusedVerticesAreDropped) {
  EXPECT_NEAR(make(as_obj(kBox) + "v 9 9 9\nf 1 2 3\n").volume, 6.0, 1e-6);
  std::vector<std::array<Vec3, 3>> triangles;
  for (const auto& [a, b, c] : kBox.faces)
    triangles.push_back({kBox.vertices[a], kBox.vertices[b], kBox.vertices[c]});
  triangles.push_back(triangles[4]);
  EXPECT_NEAR(make(as_stl(triangles), {}, "thing.stl").volume, 6.0, 1e-6);
  EXPECT_EQ(report_.duplicate_faces_dropped, 1);
  EXPECT_EQ(report_.vertices_welded, 39 - 8);
}

TEST_F(BadMeshFile, WithoutVolume) {
  Mesh flat = kBox;
  for (Vec3& vertex : flat.vertices) vertex.z() = 0.0;
  EXPECT_NE(error_of(as_obj(flat)).find("beside"), std::string::npos) << error_of(as_obj(flat));
  // A closed surface, folded flat: the top on another diagonal than the bottom.
  const std::string folded = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\nf 2 1 4\nf 2 4 3\n";
  EXPECT_NE(error_of(folded).find("a volume of 0 m³, expected a solid"), std::string::npos)
      << error_of(folded);
}

TEST_F(BadMeshFile, VerticesThatAreNoNumbers) {
  for (const char* bad : {"nan", "inf", "-inf", "1e39"}) {
    EXPECT_EQ(error_in_line("v " + std::string(bad) + " 0 0\n" + as_obj(kBox) + "f 1 2 3\n"),
              "1: v: found '" + std::string(bad) + "', expected a finite number");
    std::array<Vec3, 3> triangle = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
    triangle[1].x() = std::strtof(bad, nullptr);
    const std::string error = error_of(as_stl({{triangle}}), {}, "thing.stl");
    EXPECT_NE(error.find("expected finite coordinates"), std::string::npos) << error;
  }
}

// By assimp they are passed over or found later, without their line.
TEST_F(BadMeshFile, FaultsOfAnObjAreNamedByTheirLine) {
  const std::string box = as_obj(kBox);
  const std::pair<std::string, std::string> faults[] = {
      {box + "v 1 1 one\n", "21: v: found 'one', expected a finite number"},
      {box + "v 1 1\n", "21: v: found 2 numbers, expected three"},
      {box + "f 1 2 99\n", "21: f: found vertex 99, expected 1 … 8"},
      {box + "f 0 1 2\n", "21: f: found vertex 0, expected 1 … 8"},
      {box + "f 1 2 -9\n", "21: f: found vertex -9, expected one of the 8 above"},
      {box + "f 1//1 2/3 x/3\n", "21: f: found 'x/3', expected the number of a vertex"},
      {"# a\r\n\r\nf 1 2 3", "3: f: found vertex 1, expected lines v with vertices"},
      {"v 0 0 \\\n0\nv 0 0\n", "3: v: found 2 numbers, expected three"}};
  for (const auto& [bytes, fault] : faults) EXPECT_EQ(error_in_line(bytes), fault);
}

// Numbers counted back and ahead of their vertices, corners with texture, lines that go on, a decimal comma.
TEST_F(BadMeshFile, WhatAnObjMayHaveIsTaken) {
  EXPECT_NEAR(make(as_obj(kBox) + "f -8 -7 -6\n").volume, 6.0, 1e-6);
  EXPECT_NEAR(make("vt 0 0\nvn 0 0 1\nf 1/1/1 3/1 2//1\nf 1 2 4\nf 2 3 4\nf 3 1 4\nv 0 0 0\nv 1,0 0 0 # a\n"
                   "v 0 +1 0\r\nv 0 \\\n 0 1e0 .5 .5 .5\no a\n")
                  .volume,
              1.0 / 6.0, 1e-6);
}

TEST_F(BadMeshFile, AMillionAndOneFaces) {
  const std::vector<std::array<Vec3, 3>> triangles(1'000'001, {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)});
  EXPECT_EQ(error_of(as_stl(triangles), {}, "thing.stl"),
            "1000001 faces, expected at most 1000000 (simplify the mesh first)");
}

TEST_F(BadMeshFile, WrongUnits) {
  EXPECT_EQ(error_of(as_obj(kBox, 1e4)), "an extent of 30000 m, expected 0.0001 … 10000 m (wrong unit?)");
  EXPECT_EQ(error_of(as_obj(kBox, 1e-5)), "an extent of 3e-05 m, expected 0.0001 … 10000 m (wrong unit?)");
  // In millimetres it passes, for it may be meant.
  EXPECT_NEAR(make(as_obj(kBox, 1e3)).size, 3000.0, 1e-3);
}

/// While it lives a comma stands for the point in what the C library reads, as in much of Europe.
class CommaLocale {
 public:
  /// Made in `folder`; check is_set() for whether it could be.
  explicit CommaLocale(const testing::TemporaryFolder& folder) {
    std::string source = "LC_NUMERIC\ndecimal_point \",\"\nthousands_sep \"\"\ngrouping -1\nEND LC_NUMERIC\n";
    for (const std::string category : {"LC_CTYPE", "LC_COLLATE", "LC_MONETARY", "LC_TIME", "LC_MESSAGES"})
      source += category + "\ncopy \"POSIX\"\nEND " + category + "\n";
    const std::string command = "localedef -c -i '" + folder.write("source", source).string() +
                                "' -f UTF-8 '" + folder.at("comma").string() + "' >/dev/null 2>&1";
    if (std::system(command.c_str()) < 0) return;
    ::setenv("LOCPATH", folder.path().c_str(), 1);
    std::setlocale(LC_NUMERIC, "comma");
  }
  ~CommaLocale() {
    std::setlocale(LC_NUMERIC, "C");
    ::unsetenv("LOCPATH");
  }
  CommaLocale(const CommaLocale&) = delete;
  CommaLocale& operator=(const CommaLocale&) = delete;
  static bool is_set() { return std::string_view(std::localeconv()->decimal_point) == ","; }
};

TEST_F(BadMeshFile, TheProgramsLocaleDoesNotMatter) {
  const std::string obj = as_obj(make_box({0.25, 0.5, 1.5}));
  const CommaLocale comma(folder_);
  if (!CommaLocale::is_set()) GTEST_SKIP() << "no localedef here";
  EXPECT_NEAR(make(obj).volume, 0.25 * 0.5 * 1.5, 1e-9);
  EXPECT_NE(error_in_line("v 0 0 1.5x\n"), testing::kNothingThrown);
}

// The greatest mesh that is taken is loaded, mended and made a shape of.
TEST(LongBadMeshFile, AMillionFacesAreTaken) {
  constexpr int kCells = 288;  // on each edge of the box: 12 × 288² faces
  std::vector<std::array<Vec3, 3>> triangles;
  const auto sphere_of = [](const Vec3& v) { return Vec3(v.normalized()); };
  for (const auto& [a, b, c] : make_box({2, 2, 2}).faces) {
    const Vec3 origin = make_box({2, 2, 2}).vertices[a],
               u = (make_box({2, 2, 2}).vertices[b] - origin) / kCells,
               v = (make_box({2, 2, 2}).vertices[c] - origin) / kCells;
    for (int i = 0; i < kCells; ++i)
      for (int j = 0; i + j < kCells; ++j) {
        const Vec3 at = origin + i * u + j * v;
        triangles.push_back({sphere_of(at), sphere_of(at + u), sphere_of(at + v)});
        if (i + j + 1 < kCells)
          triangles.push_back({sphere_of(at + u), sphere_of(at + u + v), sphere_of(at + v)});
      }
  }
  const fs::path file =
      fs::path(::testing::TempDir()) / ("lodestone_million_" + std::to_string(getpid()) + ".stl");
  std::ofstream(file, std::ios::binary) << as_stl(triangles);
  MeshReport report;
  const Shape ball = make_shape("ball", load_mesh(file), {}, &report);
  fs::remove(file);
  EXPECT_EQ(ball.mesh.faces.size(), 12u * kCells * kCells);
  EXPECT_TRUE(report.closed());
  EXPECT_NEAR(ball.volume, 4.18879, 1e-3);
}

}  // namespace
}  // namespace lodestone::bad_mesh_files_test
