#include <gtest/gtest.h>

#include "tests/scenes/scene_sections.h"

namespace lodestone {
namespace {

class ShapeSection : public SceneFixture {
 protected:
  /// The shape `s` that this says.
  Shape made(const std::string& shape) const {
    return *load(testing::scene_of("shapes: {s: " + shape +
                                   "}\nbodies: [{shape: s, position_m: [0, 0, 5]}]\n"))
                .shapes.at("s");
  }
  std::string fault(const std::string& shape) const {
    return error_of(
        testing::scene_of("shapes:\n  s: " + shape + "\nbodies: [{shape: s, position_m: [0, 0, 5]}]\n"));
  }
};

TEST_F(ShapeSection, SolidsHaveTheVolumesOfTheirLengths) {
  EXPECT_NEAR(made("{box_m: [1, 2, 3]}").volume, 6.0, 1e-12);
  EXPECT_NEAR(made("{plate_m: [1, 2, 0.1]}").volume, 0.2, 1e-12);
  EXPECT_NEAR(made("{l_m: [3, 2, 1, 0.5]}").volume, 0.5 * (3 + 2 - 1), 1e-9);
  EXPECT_NEAR(made("{needle_m: [2, 0.1]}").volume, 2.0 * 1.5 * std::sqrt(3.0) * 0.01, 1e-9);
  EXPECT_EQ(made("{sphere_m: 0.3}").sphere_radius, 0.3);
}

TEST_F(ShapeSection, NamesAndMaterialsArrive) {
  const Scene scene = load(
      testing::scene_of("materials: {wood: {density_kg_per_m3: 500}}\n"
                        "shapes: {a: {box_m: [1, 1, 1], material: wood}, b: {box_m: [1, 1, 1]}}\n"
                        "bodies: [{shape: a, position_m: [0, 0, 5]}, {shape: b, position_m: [5, 0, 5]}]\n"));
  EXPECT_EQ(scene.shapes.at("a")->name, "a");
  EXPECT_EQ(scene.bodies[0].definition.material, 1);
  EXPECT_EQ(scene.bodies[1].definition.material, 0);
}

// An inertia is over the mass beside it; three numbers are its diagonal.
TEST_F(ShapeSection, AnInertiaIsOverTheMass) {
  for (const char* inertia : {"[2, 3, 4]", "[[2, 0, 0], [0, 3, 0], [0, 0, 4]]"}) {
    const Shape shape = made(std::string("{box_m: [1, 1, 1], mass_kg: 10, inertia: ") + inertia + "}");
    EXPECT_LT((shape.inertia_per_mass - Mat3(Vec3(0.2, 0.3, 0.4).asDiagonal())).norm(), 1e-12);
  }
  EXPECT_NE(fault("{box_m: [1, 1, 1], inertia: [1, 1, 1]}")
                .find("s.inertia: found an inertia without a mass, expected mass_kg beside it"),
            std::string::npos);
  for (const char* impossible : {"[1, 1, 100]", "[0, 1, 1]", "[[1, 2, 0], [0, 1, 0], [0, 0, 1]]"})
    EXPECT_NE(fault(std::string("{box_m: [1, 1, 1], mass_kg: 1, inertia: ") + impossible + "}"),
              testing::kNothingThrown)
        << impossible;
}

TEST_F(ShapeSection, ACentreOfMassIsWithinTheHull) {
  EXPECT_EQ(made("{box_m: [1, 1, 1], center_of_mass_m: [0, 0, -0.3]}").center_of_mass_in_mesh,
            Vec3(0, 0, -0.3));
  EXPECT_NE(fault("{box_m: [1, 1, 1], center_of_mass_m: [0, 0, -0.6]}"), testing::kNothingThrown);
}

TEST_F(ShapeSection, OneKindAndItsOwnKeysAlone) {
  EXPECT_NE(fault("{box_m: [1, 1, 1], sphere_m: 1}").find("box_m and sphere_m"), std::string::npos);
  EXPECT_NE(fault("{}").find("found none"), std::string::npos);
  EXPECT_NE(fault("{box_m: [1, 1, 1], size_m: 1}"), testing::kNothingThrown);
  EXPECT_NE(fault("{bx_m: [1, 1, 1]}").find("did you mean \"box_m\"?"), std::string::npos);
  for (const char* lengths : {"[1, 1]", "[1, 1, 0]", "[1, 1, -1]", "[1, 1, .nan]", "[1, 1, x]", "1"})
    EXPECT_TRUE(fault(std::string("{box_m: ") + lengths + "}").starts_with("s.yaml:3: shapes.s.box_m"))
        << lengths << fault(std::string("{box_m: ") + lengths + "}");
}

TEST_F(ShapeSection, MeshesAreScaledAndNeedAMassWhereTheyAreOpen) {
  write(tetrahedron_obj(), "t.obj");
  write("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\n", "open.obj");
  EXPECT_NEAR(made("{mesh: t.obj, size_m: 0.25}").size, 0.25, 1e-12);
  EXPECT_NE(fault("{mesh: open.obj}"), testing::kNothingThrown);
  EXPECT_NE(fault("{mesh: none.obj, obtain: ask the neighbour}").find("To obtain it: ask the neighbour"),
            std::string::npos);
}

}  // namespace
}  // namespace lodestone
