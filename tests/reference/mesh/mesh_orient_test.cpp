#include "reference/mesh/mesh_orient.h"

#include <gtest/gtest.h>

#include "reference/error.h"
#include "reference/mesh/mass_properties.h"
#include "tests/message_of.h"

namespace lodestone {
namespace {

void append(Mesh& mesh, const Mesh& more, const Vec3& offset = Vec3::Zero(), bool inside_out = false) {
  const int first = int(mesh.vertices.size());
  for (const Vec3& vertex : more.vertices) mesh.vertices.push_back(vertex + offset);
  for (auto [a, b, c] : more.faces) {
    if (inside_out) std::swap(b, c);
    mesh.faces.push_back({first + a, first + b, first + c});
  }
}

double volume(const Mesh& mesh) { return measure_mass_properties(mesh).volume; }

TEST(MeshOrient, FacesTurnedRoundAreTurnedBack) {
  Mesh mesh = make_box({1, 2, 3});
  const auto right = mesh.faces;
  for (const std::size_t face : {0, 3, 7}) std::swap(mesh.faces[face][1], mesh.faces[face][2]);
  MeshReport report;
  orient_faces(mesh, "box", report);
  EXPECT_EQ(report.faces_flipped, 3);
  EXPECT_EQ(report.components, 1);
  EXPECT_TRUE(report.closed());
  EXPECT_NEAR(volume(mesh), 6.0, 1e-12);
  EXPECT_EQ(mesh.faces, right);
}

TEST(MeshOrient, ASolidInsideOutIsTurnedAsAWhole) {
  Mesh mesh;
  append(mesh, make_box({1, 1, 1}), Vec3::Zero(), true);
  ASSERT_NEAR(volume(mesh), -1.0, 1e-12);
  MeshReport report;
  orient_faces(mesh, "box", report);
  EXPECT_EQ(report.faces_flipped, 12);
  EXPECT_NEAR(volume(mesh), 1.0, 1e-12);
}

// A shell has a cavity, and what lies in the cavity is solid again.
TEST(MeshOrient, PiecesInsideOneAnotherAlternate) {
  for (const bool inside_out : {false, true}) {
    Mesh mesh;
    append(mesh, make_box({3, 3, 3}), Vec3::Zero(), inside_out);
    append(mesh, make_box({2, 2, 2}), Vec3::Zero(), inside_out);
    append(mesh, make_box({1, 1, 1}), Vec3::Zero(), inside_out);
    append(mesh, make_box({1, 1, 1}), {10, 0, 0}, inside_out);
    MeshReport report;
    orient_faces(mesh, "shells", report);
    EXPECT_EQ(report.components, 4);
    EXPECT_NEAR(volume(mesh), 27.0 - 8.0 + 1.0 + 1.0, 1e-12);
    EXPECT_EQ(report.faces_flipped, inside_out ? 36 : 12);
  }
}

// A bar that sticks in a leg of an L, whichever of its vertices comes first.
TEST(MeshOrient, WhatSticksInAnotherIsNoCavity) {
  for (const bool other_end_first : {false, true}) {
    Mesh bar = make_box({0.3, 0.05, 0.05});
    if (other_end_first)
      for (Vec3& vertex : bar.vertices) vertex.x() = -vertex.x();  // and inside out
    Mesh mesh = make_l(1.0, 1.0, 0.2, 0.2);
    Vec3 corner = mesh.vertices.front();
    for (const Vec3& vertex : mesh.vertices) corner = corner.cwiseMin(vertex);
    const double l = volume(mesh);
    append(mesh, bar, corner + Vec3(0.3, 0.6, 0.1), false);  // from x .15, in the leg, to .45, in the notch
    MeshReport report;
    orient_faces(mesh, "lever", report);
    EXPECT_EQ(report.components, 2);
    EXPECT_NEAR(volume(mesh), l + 0.3 * 0.05 * 0.05, 1e-12);
    EXPECT_EQ(report.faces_flipped, other_end_first ? 12 : 0);
  }
}

TEST(MeshOrient, OpenAndCrowdedEdgesAreCounted) {
  Mesh open = make_box({1, 1, 1});
  open.faces.pop_back();
  MeshReport report;
  orient_faces(open, "open", report);
  EXPECT_EQ(report.open_edges, 3);
  EXPECT_EQ(report.non_manifold_edges, 0);

  Mesh fin = make_box({1, 1, 1});
  fin.vertices.emplace_back(3, 3, 3);
  fin.faces.push_back({fin.faces[0][0], fin.faces[0][1], 8});
  MeshReport crowded;
  orient_faces(fin, "fin", crowded);
  EXPECT_EQ(crowded.non_manifold_edges, 1);
  EXPECT_EQ(crowded.open_edges, 2);
}

TEST(MeshOrient, AMoebiusBandIsRefusedByName) {
  Mesh band;
  constexpr int kSides = 8;
  for (int i = 0; i < kSides; ++i) {
    const double along = 2.0 * 3.14159265358979 * i / kSides;
    const Vec3 out(std::cos(along), std::sin(along), 0),
        across = std::cos(0.5 * along) * out + std::sin(0.5 * along) * Vec3::UnitZ();
    band.vertices.push_back(out - 0.3 * across);
    band.vertices.push_back(out + 0.3 * across);
  }
  for (int i = 0; i < kSides; ++i) {
    const int a = 2 * i, b = a + 1, last = i + 1 == kSides, c = last ? 1 : a + 2, d = last ? 0 : a + 3;
    band.faces.push_back({a, c, b});
    band.faces.push_back({b, c, d});
  }
  MeshReport report;
  const std::string message = testing::message_of([&] { orient_faces(band, "band.obj", report); });
  EXPECT_TRUE(message.starts_with("band.obj: found a one-sided surface")) << message;
}

}  // namespace
}  // namespace lodestone
