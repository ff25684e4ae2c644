// Hull contacts with a plane against ODE's own brute force over the mesh.
#include "reference/ode/plane_contacts.h"

#include <gtest/gtest.h>
#include <ode/ode.h>

#include <algorithm>

#include "reference/random.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

std::shared_ptr<const Shape> shape_named(const std::string& name) {
  if (name == "box") return box_shape({0.2, 0.3, 0.4});
  if (name == "l") return std::make_shared<const Shape>(make_shape("l", make_l(0.3, 0.3, 0.1, 0.1)));
  if (name == "ball") return std::make_shared<const Shape>(make_shape("ball", make_sphere(0.15)));
  return std::make_shared<const Shape>(make_bunny_shape(0.3));
}

double deepest_by_ode(const Shape& shape, const Quat& orientation, double height) {
  static_cast<void>(dInitODE2(0));
  std::vector<dReal> vertices;
  std::vector<dTriIndex> indices;
  for (const Vec3& v : shape.mesh.vertices) vertices.insert(vertices.end(), {v.x(), v.y(), v.z()});
  for (const auto& f : shape.mesh.faces)
    indices.insert(indices.end(), {dTriIndex(f[0]), dTriIndex(f[1]), dTriIndex(f[2])});
  const dTriMeshDataID data = dGeomTriMeshDataCreate();
  dGeomTriMeshDataBuildDouble(data, vertices.data(), 3 * sizeof(dReal), int(shape.mesh.vertices.size()),
                              indices.data(), int(indices.size()), 3 * sizeof(dTriIndex));
  const dGeomID mesh = dCreateTriMesh(nullptr, data, nullptr, nullptr, nullptr),
                plane = dCreatePlane(nullptr, 0, 0, 1, 0);
  dGeomSetPosition(mesh, 0, 0, height);
  const dQuaternion q = {orientation.w(), orientation.x(), orientation.y(), orientation.z()};
  dGeomSetQuaternion(mesh, q);
  std::vector<dContactGeom> found(shape.mesh.vertices.size());
  const int count = dCollide(mesh, plane, int(found.size()), found.data(), sizeof(dContactGeom));
  double deepest = 0.0;
  for (int i = 0; i < count; ++i) deepest = std::max(deepest, double(found[i].depth));
  dGeomDestroy(mesh), dGeomDestroy(plane);
  dGeomTriMeshDataDestroy(data);
  return deepest;
}

class PlaneContacts : public ::testing::TestWithParam<std::string> {};

TEST_P(PlaneContacts, DeepestIsThatOfTheMesh) {
  const auto shape = shape_named(GetParam());
  PlaneContactFinder finder;
  int start = 0;
  for (std::uint32_t pose = 0; pose < 200; ++pose) {
    RandomStream random(11, pose, 0);
    const Quat orientation = random.orientation();
    const double height = shape->radius * random.uniform(0.3, 1.0);
    const auto found = finder.find(shape->hull, orientation.conjugate() * Vec3::UnitZ(), -height, 8, start);
    const double deepest = found.empty() ? 0.0 : found[0].depth;
    EXPECT_NEAR(deepest, deepest_by_ode(*shape, orientation, height), 1e-7) << "pose " << pose;
  }
}

TEST_P(PlaneContacts, FloodFindsWhatAScanFinds) {
  const auto shape = shape_named(GetParam());
  PlaneContactFinder finder;
  int start = 0;
  for (std::uint32_t pose = 0; pose < 200; ++pose) {
    RandomStream random(12, pose, 0);
    const Vec3 normal = random.direction();
    const double offset = -shape->radius * random.uniform(0.0, 1.0);
    std::vector<PlaneContact> expected;
    for (int i = 0; i < int(shape->hull.vertices.size()); ++i)
      if (const double depth = offset - normal.dot(shape->hull.vertices[i]); depth > 0.0)
        expected.push_back({i, depth});
    std::ranges::sort(expected, [](const auto& a, const auto& b) {
      return a.depth != b.depth ? a.depth > b.depth : a.vertex < b.vertex;
    });
    std::int64_t dropped = 0;
    const auto found = finder.find(shape->hull, normal, offset, 8, start, &dropped);
    ASSERT_EQ(found.size() + dropped, expected.size()) << "pose " << pose;
    for (std::size_t i = 0; i < found.size(); ++i)
      EXPECT_EQ(found[i].vertex, expected[i].vertex) << "pose " << pose;
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, PlaneContacts, ::testing::Values("box", "l", "ball", "bunny"),
                         [](const auto& shape) { return shape.param; });

TEST(PlaneContactFinder, ResultDoesNotDependOnTheStart) {
  const auto shape = shape_named("ball");
  PlaneContactFinder finder;
  int zero = 0;
  const auto first = finder.find(shape->hull, Vec3::UnitZ(), -0.1, 8, zero);
  const std::vector<PlaneContact> expected(first.begin(), first.end());
  ASSERT_FALSE(expected.empty());
  for (int start = 0; start < int(shape->hull.vertices.size()); start += 17) {
    int from = start;
    const auto again = finder.find(shape->hull, Vec3::UnitZ(), -0.1, 8, from);
    ASSERT_EQ(again.size(), expected.size());
    for (std::size_t i = 0; i < again.size(); ++i) EXPECT_EQ(again[i].vertex, expected[i].vertex);
  }
}

}  // namespace
}  // namespace lodestone
