#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <numbers>

#include "reference/error.h"
#include "reference/mesh/mass_properties.h"
#include "reference/mesh/mesh.h"
#include "reference/random.h"
#include "tests/message_of.h"

namespace lodestone {
namespace {

struct Repaired {
  Mesh mesh;
  MeshReport report;
  double volume() const { return measure_mass_properties(mesh).volume; }
};

Repaired repair(const Mesh& mesh) {
  Repaired repaired;
  repaired.mesh = repair_mesh(mesh, "test", &repaired.report);
  return repaired;
}

std::string error_of(const Mesh& mesh) {
  return testing::message_of([&] { repair_mesh(mesh, "thing.obj"); });
}

Mesh joined(const Mesh& a, const Mesh& b, const Vec3& shift_of_b = Vec3::Zero()) {
  Mesh both = a;
  for (const Vec3& vertex : b.vertices) both.vertices.push_back(vertex + shift_of_b);
  for (auto face : b.faces) {
    for (int& i : face) i += int(a.vertices.size());
    both.faces.push_back(face);
  }
  return both;
}

Mesh turned_inside_out(Mesh mesh) {
  for (auto& face : mesh.faces) std::swap(face[0], face[1]);
  return mesh;
}

/// Every face with vertices of its own, as STL files have them.
Mesh shattered(const Mesh& mesh) {
  Mesh parts;
  for (const auto& [a, b, c] : mesh.faces) {
    const int first = int(parts.vertices.size());
    parts.vertices.insert(parts.vertices.end(), {mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]});
    parts.faces.push_back({first, first + 1, first + 2});
  }
  return parts;
}

TEST(Repair, WeldsVerticesOfSeparateFaces) {
  const auto [mesh, report] = repair(shattered(make_box({1, 1, 1})));
  EXPECT_EQ(mesh.vertices.size(), 8u);
  EXPECT_EQ(report.vertices_welded, 28);
  EXPECT_EQ(report.unused_vertices_dropped, 0);
  EXPECT_TRUE(report.closed());
}

TEST(Repair, WeldsAcrossRoundingButNotAcrossGaps) {
  Mesh rounded = shattered(make_box({1, 1, 1})), apart = rounded;
  RandomStream random(1, 0, 0);
  for (Vec3& vertex : rounded.vertices) vertex += 2e-8 * random.direction();
  for (Vec3& vertex : apart.vertices) vertex += 1e-4 * random.direction();
  EXPECT_TRUE(repair(rounded).report.closed());
  EXPECT_EQ(repair(apart).report.open_edges, 36);
}

TEST(Repair, DropsDegenerateDuplicateAndUnused) {
  Mesh mesh = make_box({1, 1, 1});
  mesh.faces.push_back({0, 1, 1});
  mesh.faces.push_back({2, 2, 2});
  mesh.faces.push_back(mesh.faces[3]);
  mesh.faces.push_back({mesh.faces[5][1], mesh.faces[5][0], mesh.faces[5][2]});  // the other way round
  mesh.vertices.push_back({0.1, 0.2, 0.3});
  const auto [repaired, report] = repair(mesh);
  EXPECT_EQ(report.degenerate_faces_dropped, 2);
  EXPECT_EQ(report.duplicate_faces_dropped, 2);
  EXPECT_EQ(report.unused_vertices_dropped, 1);
  EXPECT_EQ(hash_of(repaired), hash_of(make_box({1, 1, 1})));
}

TEST(Repair, MakesADoubleSidedSolidSingle) {
  const Mesh box = make_box({1, 1, 1});
  const Repaired repaired = repair(joined(box, turned_inside_out(box)));
  EXPECT_EQ(repaired.report.duplicate_faces_dropped, 12);
  EXPECT_TRUE(repaired.report.closed());
  EXPECT_NEAR(repaired.volume(), 1.0, 1e-15);
}

TEST(Repair, DropsTheWallInsideGluedBoxes) {
  // Side by side with the wall twice, its diagonals alike: the two walls vanish and one solid is left.
  const Mesh box = make_box({1, 1, 1});
  Mesh mirrored = turned_inside_out(box);
  for (Vec3& vertex : mirrored.vertices) vertex.x() = 1.0 - vertex.x();
  const Repaired repaired = repair(joined(box, mirrored));
  EXPECT_EQ(repaired.report.duplicate_faces_dropped, 4);
  EXPECT_TRUE(repaired.report.closed());
  EXPECT_EQ(repaired.report.components, 1);
  EXPECT_NEAR(repaired.volume(), 2.0, 1e-14);
}

TEST(Repair, DropsFlatFacesUnlessTheyFillASeam) {
  // A sliver laid on a closed box goes …
  Mesh with_sliver = make_box({1, 1, 1});
  with_sliver.vertices.push_back(0.5 * (with_sliver.vertices[0] + with_sliver.vertices[1]));
  with_sliver.faces.push_back({0, 1, 8});
  EXPECT_EQ(repair(with_sliver).report.degenerate_faces_dropped, 1);
  EXPECT_TRUE(repair(with_sliver).report.closed());

  // … one that joins a split edge to the unsplit face beside it stays.
  Mesh seamed = make_box({1, 1, 1});
  seamed.vertices.push_back(0.5 * (seamed.vertices[0] + seamed.vertices[1]));
  for (std::size_t i = 0; i < seamed.faces.size(); ++i) {
    auto& face = seamed.faces[i];
    for (int k = 0; k < 3; ++k)
      if (face[k] == 0 && face[(k + 1) % 3] == 1) {  // split this side only
        const int apex = face[(k + 2) % 3];
        face = {0, 8, apex};
        seamed.faces.push_back({8, 1, apex});
        seamed.faces.push_back({1, 8, 0});
        i = seamed.faces.size();
        break;
      }
  }
  const Repaired repaired = repair(seamed);
  EXPECT_EQ(repaired.report.degenerate_faces_dropped, 0);
  EXPECT_TRUE(repaired.report.closed());
  EXPECT_NEAR(repaired.volume(), 1.0, 1e-15);
}

TEST(Repair, TurnsFacesOutwards) {
  const Mesh box = make_box({1, 2, 3});
  EXPECT_EQ(repair(box).report.faces_flipped, 0);
  EXPECT_EQ(repair(turned_inside_out(box)).report.faces_flipped, 12);
  EXPECT_NEAR(repair(turned_inside_out(box)).volume(), 6.0, 1e-14);
  for (std::uint32_t trial = 0; trial < 20; ++trial) {
    RandomStream random(2, 0, trial);
    Mesh mixed = make_sphere(1.0, 2);
    const double volume = measure_mass_properties(mixed).volume;
    int flipped = 0;
    for (auto& face : mixed.faces)
      if (random.uniform() < 0.5) std::swap(face[0], face[1]), ++flipped;
    const Repaired repaired = repair(mixed);
    EXPECT_EQ(repaired.report.faces_flipped, flipped);
    EXPECT_NEAR(repaired.volume(), volume, 1e-14);
  }
}

TEST(Repair, TurnsEachPieceOutwardsAndCavitiesInwards) {
  const Mesh big = make_box({3, 3, 3}), middle = make_box({2, 2, 2}), small = make_sphere(0.5, 2);
  const double ball = measure_mass_properties(small).volume;
  for (const Mesh& inner : {small, turned_inside_out(small)}) {
    EXPECT_NEAR(repair(joined(big, inner)).volume(), 27.0 - ball, 1e-12);
    EXPECT_NEAR(repair(joined(joined(big, middle), inner)).volume(), 27.0 - 8.0 + ball, 1e-12);
    const Repaired beside = repair(joined(big, inner, {5, 0, 0}));
    EXPECT_NEAR(beside.volume(), 27.0 + ball, 1e-12);
    EXPECT_EQ(beside.report.components, 2);
  }
}

TEST(Repair, CountsOpenAndNonManifoldEdges) {
  Mesh open = make_box({1, 1, 1});
  open.faces.pop_back();
  EXPECT_EQ(repair(open).report.open_edges, 3);
  EXPECT_FALSE(repair(open).report.closed());

  const Repaired touching =
      repair(joined(make_box({1, 1, 1}), make_box({1, 1, 1}), {1, 1, 0}));  // along one edge
  EXPECT_EQ(touching.report.non_manifold_edges, 1);
  EXPECT_EQ(touching.report.open_edges, 0);
  EXPECT_FALSE(touching.report.closed());
}

TEST(Repair, RefusesWhatBoundsNoVolume) {
  EXPECT_NE(error_of(Mesh{}).find("thing.obj: found no faces"), std::string::npos);
  EXPECT_NE(error_of(Mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}).find("found 1 faces"),
            std::string::npos);
  Mesh flat = make_box({1, 1, 1});
  for (Vec3& vertex : flat.vertices) vertex.z() *= 1e-7;  // welds into a sheet
  EXPECT_NE(error_of(flat), testing::kNothingThrown);
  Mesh line = make_box({1, 1, 1});
  for (Vec3& vertex : line.vertices) vertex.y() = vertex.z() = 0.0;
  EXPECT_NE(error_of(line), testing::kNothingThrown);
}

TEST(Repair, RefusesOneSidedSurfaces) {
  Mesh band;  // a Möbius band of 12 quads
  for (int i = 0; i < 12; ++i)
    for (double side : {-0.3, 0.3}) {
      const double angle = i * std::numbers::pi / 6.0, r = 1.0 + side * std::cos(angle / 2.0);
      band.vertices.emplace_back(r * std::cos(angle), r * std::sin(angle), side * std::sin(angle / 2.0));
    }
  for (int i = 0; i < 12; ++i) {
    const int a = 2 * i, b = a + 1, c = i < 11 ? a + 2 : 1, d = i < 11 ? a + 3 : 0;
    band.faces.push_back({a, b, c});
    band.faces.push_back({b, d, c});
  }
  EXPECT_NE(error_of(band).find("one-sided"), std::string::npos);
}

TEST(Repair, RefusesBadNumbersAndUnits) {
  const Mesh box = make_box({1, 1, 1});
  for (double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    Mesh broken = box;
    broken.vertices[3].y() = broken.vertices[5].z() = bad;
    EXPECT_NE(error_of(broken).find("found 2 vertices that are not finite"), std::string::npos);
  }
  for (int bad : {-1, 8, std::numeric_limits<int>::max(), std::numeric_limits<int>::min()}) {
    Mesh broken = box;
    broken.faces[4][1] = bad;
    EXPECT_NE(error_of(broken).find("found 1 faces with indices out of range"), std::string::npos);
  }
  for (double scale : {1e5, 1e-5, 1e200}) {
    Mesh scaled = box;
    for (Vec3& vertex : scaled.vertices) vertex *= scale;
    EXPECT_NE(error_of(scaled).find("wrong unit?"), std::string::npos);
  }
}

TEST(Repair, RefusesAThousandPieces) {
  Mesh dust;
  for (int i = 0; i < 1001; ++i)
    dust = i == 0 ? make_box({0.1, 0.1, 0.1}) : joined(dust, make_box({0.1, 0.1, 0.1}), {0.2 * i, 0, 0});
  EXPECT_NE(error_of(dust).find("pieces"), std::string::npos);
}

TEST(HashOfMesh, SeesEveryVertexAndFace) {
  const Mesh box = make_box({1, 1, 1});
  Mesh moved = box, turned = box;
  moved.vertices[7].z() += 1e-12;
  std::swap(turned.faces[11][0], turned.faces[11][1]);
  EXPECT_EQ(hash_of(box), hash_of(make_box({1, 1, 1})));
  EXPECT_NE(hash_of(box), hash_of(moved));
  EXPECT_NE(hash_of(box), hash_of(turned));
}

}  // namespace
}  // namespace lodestone
