#include "reference/shape.h"

#include <gtest/gtest.h>

#include <functional>
#include <numbers>
#include <set>

#include "reference/error.h"
#include "tests/message_of.h"

namespace lodestone {
namespace {

Mesh open_box() {
  Mesh mesh = make_box({1, 1, 1});
  mesh.faces.pop_back();
  return mesh;
}

// Along x, with a step of a twentieth of its length.
Mesh stepped_bar(double length) {
  const double outline[][2] = {{0, 0},       {1, 0},      {1, 0.1},   {0.45, 0.1},
                               {0.45, 0.15}, {0.4, 0.15}, {0.4, 0.1}, {0, 0.1}};
  Mesh mesh;
  for (const double z : {0.0, 0.08})
    for (const auto& [x, y] : outline) mesh.vertices.push_back(length * Vec3(x, y, z));
  const int caps[][3] = {{0, 1, 3}, {1, 2, 3}, {0, 3, 6}, {0, 6, 7}, {3, 4, 5}, {3, 5, 6}};
  for (const auto& [a, b, c] : caps)
    mesh.faces.push_back({a, c, b}), mesh.faces.push_back({a + 8, b + 8, c + 8});
  for (int a = 0; a < 8; ++a) {
    const int b = (a + 1) % 8;
    mesh.faces.push_back({a, b, b + 8}), mesh.faces.push_back({a, b + 8, a + 8});
  }
  return mesh;
}

TEST(Shape, OfABox) {
  Mesh mesh = make_box({0.2, 0.3, 0.4});
  for (Vec3& vertex : mesh.vertices) vertex += Vec3(1, 2, 3);
  const Shape shape = make_shape("crate", mesh);
  EXPECT_EQ(shape.name, "crate");
  EXPECT_LE((shape.center_of_mass_in_mesh - Vec3(1, 2, 3)).norm(), 1e-14);
  EXPECT_NEAR(shape.radius, 0.5 * std::sqrt(0.29), 1e-14);
  EXPECT_NEAR(shape.size, 0.4, 1e-14);
  EXPECT_NEAR(shape.volume, 0.024, 1e-15);
  EXPECT_FALSE(shape.sphere_radius);
  EXPECT_LE((shape.inertia_per_mass * shape.inverse_inertia_per_mass - Mat3::Identity()).norm(), 1e-12);
  EXPECT_LE(measure_mass_properties(shape.mesh).center_of_mass.norm(), 1e-14);
  EXPECT_EQ(shape.hull.vertices.size(), 8u);
}

TEST(Shape, OfASphereIsExact) {
  const Shape shape = make_sphere_shape(0.1);
  EXPECT_EQ(shape.sphere_radius, 0.1);
  EXPECT_EQ(shape.radius, 0.1);
  EXPECT_EQ(shape.size, 0.2);
  EXPECT_NEAR(shape.volume, 4e-3 / 3.0 * std::numbers::pi, 1e-16);
  EXPECT_NEAR(shape.inertia_per_mass(1, 1), 0.4 * 0.01, 1e-16);
  EXPECT_EQ(shape.mesh.faces.size(), 1280u);
  EXPECT_THROW(make_sphere_shape(-1), InputError);
  EXPECT_THROW(make_sphere_shape(1e6), InputError);
}

TEST(Shape, OfTheBunny) {
  MeshReport report;
  const Shape bunny = make_bunny_shape(0.2);
  repair_mesh(bunny.mesh, "bunny", &report);
  EXPECT_TRUE(report.closed());
  EXPECT_EQ(report.components, 1);
  EXPECT_EQ(report.faces_flipped, 0);
  EXPECT_EQ(bunny.mesh.faces.size(), 4698u);
  EXPECT_NEAR(bunny.size, 0.2, 1e-12);
  EXPECT_EQ(make_bunny_shape(0.2, 194).mesh.faces.size(), 194u);
}

TEST(ContentHash, IsEqualForScaledCopies) {
  for (const Mesh& mesh :
       {make_box({0.2, 0.3, 0.4}), make_l(0.3, 0.2, 0.05, 0.1), make_needle(1, 0.02), make_sphere(0.7)}) {
    const std::uint64_t hash = make_shape("original", mesh).content_hash;
    for (double scale : {1e-3, 0.013, 0.3, 1.7, 10.0}) {
      Mesh copy = mesh;
      for (Vec3& vertex : copy.vertices) vertex *= scale;
      EXPECT_EQ(make_shape("copy", copy).content_hash, hash) << scale;
    }
  }
  const std::uint64_t bunny = make_bunny_shape(0.2).content_hash;
  for (double size : {1e-3, 0.37, 10.0}) EXPECT_EQ(make_bunny_shape(size).content_hash, bunny);
  EXPECT_EQ(make_sphere_shape(0.1).content_hash, make_sphere_shape(3.0).content_hash);
}

// What a signature is measured on: whoever asks first, all copies then have the same trials.
TEST(ContentHash, OfScaledCopiesStandsForTheSameShapeToTheBit) {
  for (const Mesh& mesh : {make_box({0.2, 0.3, 0.4}), make_l(0.3, 0.2, 0.05, 0.1), make_needle(1, 0.02),
                           make_bunny_shape(0.2).mesh}) {
    const Shape original = make_shape("original", mesh);
    const Shape expected = make_hashed_copy(original, 0.2);
    EXPECT_EQ(expected.content_hash, original.content_hash);
    EXPECT_EQ(expected.radius, 0.2);
    EXPECT_EQ(make_hashed_copy(expected, 0.2).mesh.vertices, expected.mesh.vertices);
    EXPECT_LT(
        (expected.inertia_per_mass / 0.04 - original.inertia_per_mass / std::pow(original.radius, 2)).norm(),
        1e-7);
    for (double scale : {1e-3, 0.013, 0.3, 1.7, 10.0}) {
      Mesh scaled = mesh;
      for (Vec3& vertex : scaled.vertices) vertex *= scale;
      const Shape copy = make_hashed_copy(make_shape("copy", scaled), 0.2);
      EXPECT_EQ(copy.mesh.vertices, expected.mesh.vertices) << scale;
      EXPECT_EQ(copy.hull.faces, expected.hull.faces);
      EXPECT_EQ(copy.inertia_per_mass, expected.inertia_per_mass);
      EXPECT_EQ(copy.radius, expected.radius);
    }
  }
}

TEST(ContentHash, DiffersForOtherShapesAndOtherMass) {
  const Mesh box = make_box({0.2, 0.3, 0.4});
  const Mat3 inertia = make_shape("box", box).inertia_per_mass;
  std::set<std::uint64_t> hashes;
  hashes.insert(make_shape("box", box).content_hash);
  hashes.insert(make_shape("box", make_box({0.2, 0.3, 0.401})).content_hash);
  hashes.insert(make_shape("box", box, {.center_of_mass_m = Vec3(0, 0, 0.01)}).content_hash);
  hashes.insert(make_shape("box", box, {.inertia_per_mass_m2 = 1.01 * inertia}).content_hash);
  hashes.insert(make_sphere_shape(0.1).content_hash);
  hashes.insert(make_shape("sphere", make_sphere(0.1)).content_hash);
  hashes.insert(make_bunny_shape(0.2).content_hash);
  hashes.insert(make_bunny_shape(0.2, 194).content_hash);
  EXPECT_EQ(hashes.size(), 8u);
}

TEST(Shape, OfAnOpenMeshNeedsItsMassGiven) {
  const Mat3 inertia = Mat3::Identity() / 6.0;
  const std::string message = testing::message_of([] { make_shape("shell", open_box()); });
  EXPECT_NE(message.find("shell: found 3 open edges"), std::string::npos) << message;
  EXPECT_THROW(make_shape("shell", open_box(), {.center_of_mass_m = Vec3::Zero()}), InputError);
  EXPECT_THROW(make_shape("shell", open_box(), {.inertia_per_mass_m2 = inertia}), InputError);

  MeshReport report;
  const Shape shape = make_shape(
      "shell", open_box(), {.center_of_mass_m = Vec3(0, 0, 0.1), .inertia_per_mass_m2 = inertia}, &report);
  EXPECT_EQ(report.open_edges, 3);
  EXPECT_EQ(shape.inertia_per_mass, inertia);
  EXPECT_NEAR(shape.volume, 1.0, 1e-12);
  EXPECT_NEAR(shape.hull.vertices[find_support(shape.hull, Vec3::UnitZ())].z(), 0.4, 1e-12);
}

TEST(Shape, WithAnImpossibleMassIsRefused) {
  const Mesh box = make_box({1, 1, 1});
  EXPECT_THROW(make_shape("box", box, {.inertia_per_mass_m2 = Mat3(Vec3(1, 1, 100).asDiagonal())}),
               InputError);
  EXPECT_THROW(make_shape("box", box, {.inertia_per_mass_m2 = Mat3::Zero()}), InputError);
  EXPECT_THROW(make_shape("box", box, {.inertia_per_mass_m2 = Mat3::Constant(std::nan(""))}), InputError);
  EXPECT_THROW(make_shape("box", box, {.center_of_mass_m = Vec3(0, 0, 0.6)}), InputError);
  EXPECT_THROW(make_shape("box", box, {.center_of_mass_m = Vec3(0, 0, std::nan(""))}), InputError);
  const std::string message = testing::message_of(
      [&] { make_shape("odd", box, {.inertia_per_mass_m2 = Mat3(Vec3(1, 1, 100).asDiagonal())}); });
  EXPECT_EQ(message.rfind("odd: inertia: found", 0), 0u) << message;
}

// A bar with a step, of its legal size: the step alone is smaller than any shape may be. It is then without
// pieces.
TEST(Shape, MayHaveAStepSmallerThanAShape) {
  for (const double length : {0.01, 0.0005}) {
    const Shape shape = make_shape("stepped", stepped_bar(length));
    EXPECT_FALSE(shape.convex);
    EXPECT_EQ(shape.pieces.empty(), length < 0.001) << length;
  }
}

}  // namespace
}  // namespace lodestone
