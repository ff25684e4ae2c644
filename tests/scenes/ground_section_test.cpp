#include <gtest/gtest.h>

#include "tests/scenes/scene_sections.h"

namespace lodestone {
namespace {

class GroundSection : public SceneFixture {
 protected:
  std::vector<SceneGround> made(const std::string& ground) const {
    return load(testing::scene_of("ground: [" + ground + "]\n")).ground;
  }
  std::string fault(const std::string& ground) const {
    return error_of(testing::scene_of("ground: [" + ground + "]\n"));
  }
};

TEST_F(GroundSection, APlaneWithoutMoreIsTheFloor) {
  const auto plane = std::get<GroundPlane>(made("{plane: {}}").at(0));
  EXPECT_EQ(plane.normal, Vec3(0, 0, 1));
  EXPECT_EQ(plane.offset_m, 0.0);
  EXPECT_NEAR(std::get<GroundPlane>(made("{plane: {normal: [3, 0, 4]}}").at(0)).normal.norm(), 1.0, 1e-15);
  EXPECT_NE(fault("{plane: {normal: [0, 0, 0]}}"), testing::kNothingThrown);
}

TEST_F(GroundSection, BoxesStandWhereTheyAreTurned) {
  const auto box = std::get<GroundBox>(
      made("{box: {sides_m: [1, 2, 3], position_m: [4, 5, 6], orientation: [1, 0, 0, 1]}}").at(0));
  EXPECT_EQ(box.position_m, Vec3(4, 5, 6));
  EXPECT_LT((box.orientation * Vec3(1, 0, 0) - Vec3(0, 1, 0)).norm(), 1e-12);
  EXPECT_NE(fault("{box: {sides_m: [1, 2, 0]}}"), testing::kNothingThrown);
  EXPECT_NE(fault("{box: {position_m: [1, 2, 0]}}").find("sides_m"), std::string::npos);
}

// A terrain is as many cells as it says, each of two faces, its heights at the corners.
TEST_F(GroundSection, ATerrainHasItsCellsAndHeights) {
  const auto mesh = std::get<GroundMesh>(made("{terrain: {cells: [3, 2], size_m: [6, 8], heights_m: [[0, 1, "
                                              "2, 3], [4, 5, 6, 7], [8, 9, 10, 11]]}}")
                                             .at(0));
  EXPECT_EQ(mesh.mesh.faces.size(), 2U * 3 * 2);
  ASSERT_EQ(mesh.mesh.vertices.size(), 12U);
  for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(mesh.mesh.vertices[i].z(), double(i));
  EXPECT_EQ(mesh.mesh.vertices[0], Vec3(-3, -4, 0));
  EXPECT_EQ(mesh.mesh.vertices[11], Vec3(3, 4, 11));
}

TEST_F(GroundSection, TerrainsThatDoNotFitAreRefused) {
  for (const char* terrain :
       {"{cells: [3, 2], size_m: [6, 8], heights_m: [[0, 1, 2, 3], [4, 5, 6, 7]]}",
        "{cells: [1, 1], size_m: [6, 8], heights_m: [[0, 1], [2]]}",
        "{cells: [0, 1], size_m: [6, 8], hills: []}", "{cells: [1001, 1], size_m: [6, 8], hills: []}",
        "{cells: [1, 1], size_m: [0, 8], hills: []}", "{cells: [1, 1], size_m: [6, 8]}",
        "{cells: [1, 1], size_m: [6, 8], hills: [], heights_m: [[0, 0], [0, 0]]}",
        "{cells: [1, 1], size_m: [6, 8], hills: [{height_m: 1}]}",
        "{cells: [1, 1], size_m: [6, 8], hills: [{height_m: 1, length_m: [1, 0]}]}"})
    EXPECT_TRUE(fault(std::string("{terrain: ") + terrain + "}").starts_with("s.yaml:2: ground[0].terrain"))
        << fault(std::string("{terrain: ") + terrain + "}");
}

// Stairs are solid below each step: as many boxes, each higher by the rise.
TEST_F(GroundSection, StairsAreABoxForEachStep) {
  const auto steps = made("{stairs: {steps: 5, rise_m: 0.2, run_m: 0.3, width_m: 2, position_m: [1, 2, 3]}}");
  ASSERT_EQ(steps.size(), 5U);
  double last_top = 3.0;
  for (const SceneGround& ground : steps) {
    const auto& box = std::get<GroundBox>(ground);
    const double top = box.position_m.z() + 0.5 * box.sides_m.z();
    EXPECT_NEAR(top, last_top + 0.2, 1e-12);
    EXPECT_NEAR(box.position_m.z() - 0.5 * box.sides_m.z(), 3.0, 1e-12);
    last_top = top;
  }
  EXPECT_NE(fault("{stairs: {steps: 0, rise_m: 0.2, run_m: 0.3, width_m: 2}}"), testing::kNothingThrown);
}

TEST_F(GroundSection, AMeshIsScaledAndMoved) {
  write(tetrahedron_obj(), "t.obj");
  const auto mesh =
      std::get<GroundMesh>(made("{mesh: t.obj, size_m: 10, position_m: [0, 0, -1]}").at(0)).mesh;
  Eigen::AlignedBox3d box;
  for (const Vec3& vertex : mesh.vertices) box.extend(vertex);
  EXPECT_NEAR(box.sizes().maxCoeff(), 10.0, 1e-9);
  EXPECT_NEAR(box.min().z(), -1.0, 1e-9);
  EXPECT_NE(fault("{mesh: none.obj}"), testing::kNothingThrown);
}

TEST_F(GroundSection, OneKindEach) {
  EXPECT_NE(fault("{plane: {}, box: {sides_m: [1, 1, 1]}}"), testing::kNothingThrown);
  EXPECT_NE(fault("{}"), testing::kNothingThrown);
  EXPECT_NE(fault("{plan: {}}").find("did you mean \"plane\"?"), std::string::npos);
  EXPECT_NE(fault("{plane: {}, material: ice}"), testing::kNothingThrown);
}

}  // namespace
}  // namespace lodestone
