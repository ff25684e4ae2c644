#include "reference/mesh/mesh_child.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <vector>

#include "reference/error.h"
#include "reference/sanitizers.h"
#include "tests/message_of.h"
#include "tests/temporary_folder.h"

namespace lodestone::mesh_child_test {
namespace {

std::string error_of(const std::function<Mesh()>& read, const ChildLimits& limits = {},
                     int max_faces = 1000) {
  return testing::message_of([&] { read_mesh_in_child("thing", read, max_faces, limits); });
}

TEST(MeshChild, SendsTheMesh) {
  const Mesh ball = make_sphere(1.0, 4);  // more than a pipe holds
  const Mesh came = read_mesh_in_child(
      "ball", [&] { return ball; }, 1'000'000);
  EXPECT_EQ(came.vertices, ball.vertices);
  EXPECT_EQ(came.faces, ball.faces);
}

TEST(MeshChild, SendsTheError) {
  EXPECT_EQ(error_of([]() -> Mesh { throw InputError("thing: found nothing, expected something"); }),
            "thing: found nothing, expected something");
}

TEST(MeshChild, DiesAlone) {
  EXPECT_EQ(error_of([]() -> Mesh {
              raise(SIGSEGV);
              return {};
            }).substr(0, 47),
            "thing: found its reader killed by signal 11 (Se");
  EXPECT_NE(error_of([]() -> Mesh { std::abort(); }).find("killed by signal 6"), std::string::npos);
  EXPECT_NE(error_of([]() -> Mesh { _exit(7); }).find("ended with 7"), std::string::npos);
}

TEST(MeshChild, WorksNoLongerThanItMay) {
  const auto compute = []() -> Mesh {
    volatile std::uint64_t product = 1;
    for (;;) product = 3 * product;
  };
  EXPECT_EQ(error_of(compute, {.processor_s = 1}),
            "thing: found over 1 s of reading, expected a mesh that can be read");
  EXPECT_EQ(error_of(
                []() -> Mesh {
                  for (;;) pause();
                },
                {.wall_s = 1}),
            "thing: found over 1 s of waiting for its reader, expected a mesh that can be read");
}

#if !LODESTONE_ADDRESS_SANITIZER && !LODESTONE_THREAD_SANITIZER
TEST(MeshChild, TakesNoMoreMemoryThanItMay) {
  const auto read = [] {
    Mesh mesh;
    mesh.vertices.resize(20'000'000, Vec3::Zero());  // 480 MB
    return mesh;
  };
  EXPECT_EQ(error_of(read, {.memory_bytes = 100 << 20}),
            "thing: found a file that takes over 100 MB to read, expected less");
}
#endif

TEST(MeshChild, IsNotTrusted) {
  Mesh mesh = make_box({1, 1, 1});
  EXPECT_NE(error_of([&] { return mesh; }, {}, 11).find("nonsense"), std::string::npos);
  mesh.faces[3][1] = 8;
  EXPECT_NE(error_of([&] { return mesh; }).find("out of range"), std::string::npos);
  mesh = make_box({1, 1, 1});
  mesh.vertices[2].y() = std::numeric_limits<double>::infinity();
  EXPECT_NE(error_of([&] { return mesh; }).find("not finite"), std::string::npos);
}

TEST(MeshChild, ReadsFilesOfStrangers) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path file = folder.at("child.obj");
  std::ofstream(file) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  EXPECT_EQ(load_mesh(file, {.untrusted = true}).faces.size(), 1u);
  std::ofstream(file) << "v 0 0 0\nf 1 2 3\n";
  EXPECT_THROW(load_mesh(file, {.untrusted = true}), InputError);
}

}  // namespace
}  // namespace lodestone::mesh_child_test
