#include "scenes/shape_source.h"

#include <numbers>

#include "tests/scenes/scene_fixture.h"

namespace lodestone::shape_source_test {
namespace {

using ShapeSource = SceneFixture;

TEST_F(ShapeSource, Solids) {
  EXPECT_NEAR(make_shape_from_text("box:0.2,0.3,0.4").volume, 0.024, 1e-12);
  EXPECT_NEAR(make_shape_from_text("plate:0.3,0.3,0.01").volume, 0.0009, 1e-12);
  EXPECT_NEAR(make_shape_from_text("l:.3,.2,.05,.04").volume, (0.3 + 0.15) * 0.05 * 0.04, 1e-12);
  EXPECT_NEAR(make_shape_from_text("needle:0.5,0.01").volume, 0.5 * 1.5 * std::numbers::sqrt3 * 1e-4, 1e-9);
  EXPECT_EQ(make_shape_from_text("sphere:0.1").sphere_radius, 0.1);
}

TEST_F(ShapeSource, MassOverrideReachesSolidsAndTheBunny) {
  const MassOverride mass{.center_of_mass_m = Vec3(0, 0, 0.01), .inertia_per_mass_m2 = std::nullopt};
  const Shape ball = make_solid(SolidKind::sphere, std::vector{0.1}, mass);
  EXPECT_FALSE(ball.sphere_radius);
  EXPECT_EQ(ball.center_of_mass_in_mesh, Vec3(0, 0, 0.01));
  const Shape plain = make_shape_from_text("bunny", {.size_m = 0.2, .faces = 1000});
  const Shape moved = make_shape_from_text(
      "bunny", {.size_m = 0.2, .faces = 1000},
      {.center_of_mass_m = plain.center_of_mass_in_mesh + Vec3(0, 0, 0.01), .inertia_per_mass_m2 = {}});
  EXPECT_LT((moved.mesh.vertices[0] - plain.mesh.vertices[0] + Vec3(0, 0, 0.01)).norm(), 1e-9);
}

TEST_F(ShapeSource, RefusesOtherForms) {
  for (const char* text :
       {"", "box", "box:", "box:1,2", "box:1,2,3,4", "box:1,2,x", "box:1,2,3,", "box:1,-2,3", "box:1,nan,3",
        "box:1,inf,3", "box:0,1,1", "sphere:0", "l:1,1,1,1", "cube:1", "foo", "foo:1", "sphere:1e9"})
    EXPECT_THROW(make_shape_from_text(text), InputError) << text;
}

TEST_F(ShapeSource, MeshFilesAreLookedUpInOrder) {
  std::filesystem::create_directories(folder() / "second");
  write(tetrahedron_obj(), "second/t.obj");
  const ShapeOptions both{.size_m = 0.5, .search = {folder(), folder() / "second"}};
  EXPECT_NEAR(make_shape_from_text("t.obj", both).size, 0.5, 1e-12);
  EXPECT_NEAR(make_shape_from_text((folder() / "second/t.obj").string()).size, 1.0, 1e-12);
  const std::string here = std::filesystem::relative(folder() / "second/t.obj").string();
  EXPECT_EQ(find_mesh_file(here, {}), here) << "as it was written";
  const std::string message = testing::message_of([&] { make_shape_from_text("u.obj", both); });
  EXPECT_NE(message.find("second"), std::string::npos) << message;
}

// Who gives no folders has no option for them.
TEST_F(ShapeSource, SaysHowAFolderIsAddedWhereOneCanBe) {
  const auto message = [](const ShapeOptions& options) {
    return testing::message_of([&] { make_shape_from_text("none.obj", options); });
  };
  EXPECT_EQ(message({}), "found no none.obj in ., expected a mesh file there");
  EXPECT_EQ(message({.search = {"."}}),
            "found no none.obj in ., expected a mesh file there (--mesh-path DIR adds a folder)");
}

TEST_F(ShapeSource, SimplifiesAndScales) {
  const Shape bunny = make_shape_from_text("bunny", {.size_m = 0.4, .faces = 500});
  EXPECT_NEAR(bunny.size, 0.4, 1e-9);
  EXPECT_LE(bunny.mesh.faces.size(), 550u);
}

}  // namespace
}  // namespace lodestone::shape_source_test
