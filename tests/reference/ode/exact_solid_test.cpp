#include "reference/ode/exact_solid.h"

#include <gtest/gtest.h>

#include <utility>

namespace lodestone {
namespace {

TEST(ExactSolid, IsOneOfFewConvexPieces) {
  const auto box = ode::find_exact_solid("box", make_box({1, 2, 3}));
  ASSERT_TRUE(box);
  EXPECT_EQ(ode::pieces_in_mesh(*box).size(), 1u);
  const auto l = ode::find_exact_solid("L", make_l(0.3, 0.2, 0.08, 0.1));
  ASSERT_TRUE(l);
  EXPECT_EQ(ode::pieces_in_mesh(*l).size(), 2u);
}

// Where the mesh is not about its centre of mass, the pieces lie where it does.
TEST(ExactSolid, LiesWhereItsMeshDoes) {
  for (Mesh mesh : {make_box({1, 2, 3}), make_l(0.3, 0.2, 0.08, 0.1)}) {
    for (Vec3& vertex : mesh.vertices) vertex += Vec3(5, -2, 1);
    const auto solid = ode::find_exact_solid("moved", mesh);
    ASSERT_TRUE(solid);
    Eigen::AlignedBox3d asked, found;
    for (const Vec3& vertex : mesh.vertices) asked.extend(vertex);
    for (const Piece& piece : ode::pieces_in_mesh(*solid))
      for (const Vec3& vertex : piece.shape->hull.vertices) found.extend(piece.center + vertex);
    EXPECT_LT((asked.min() - found.min()).norm() + (asked.max() - found.max()).norm(), 1e-12);
  }
}

TEST(ExactSolid, IsNoneOfAnOpenMeshARoomOrACurvedHollow) {
  Mesh open = make_box({1, 1, 1}), room = open;
  open.faces.pop_back();
  for (auto& face : room.faces) std::swap(face[0], face[1]);
  EXPECT_FALSE(ode::find_exact_solid("open", open));
  EXPECT_FALSE(ode::find_exact_solid("room", room));
  EXPECT_FALSE(ode::find_exact_solid("bunny", make_bunny_shape(0.2, 500).mesh));
  EXPECT_FALSE(ode::find_exact_solid("many", make_sphere(1.0, 4)));
}

}  // namespace
}  // namespace lodestone
