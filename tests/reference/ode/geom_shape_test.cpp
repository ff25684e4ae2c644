// The caller's geoms as plain data, and rays against them.
#include "reference/ode/geom_shape.h"

#include <gtest/gtest.h>
#include <ode/ode.h>

#include <algorithm>
#include <cmath>

#include "reference/ode/callers_bodies.h"
#include "reference/shape.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

// Turned and far from the origin, so that the geom's frame is not the world's.
void place(dGeomID geom) {
  dGeomSetPosition(geom, 10, -20, 5);
  const dQuaternion q = {0.5, 0.5, 0.5, 0.5};
  dGeomSetQuaternion(geom, q);
}

class GeomShapeOf : public ::testing::Test {
 protected:
  GeomShapeOf() {
    dInitODE2(0);
    dAllocateODEDataForThread(dAllocateMaskAll);
  }
};

TEST_F(GeomShapeOf, Primitives) {
  const dGeomID box = dCreateBox(nullptr, 1, 2, 3), ball = dCreateSphere(nullptr, 0.5),
                capsule = dCreateCapsule(nullptr, 0.25, 2), cylinder = dCreateCylinder(nullptr, 0.3, 4);
  EXPECT_EQ(read_geom(box).sides, Vec3(1, 2, 3));
  EXPECT_EQ(read_geom(ball).radius, 0.5);
  EXPECT_EQ(read_geom(capsule).kind, GeomKind::capsule);
  EXPECT_EQ(read_geom(capsule).radius, 0.25);
  EXPECT_EQ(read_geom(capsule).length, 2.0);
  EXPECT_EQ(read_geom(cylinder).radius, 0.3);
  EXPECT_EQ(read_geom(cylinder).length, 4.0);
  for (const dGeomID geom : {box, ball, capsule, cylinder}) dGeomDestroy(geom);
}

TEST_F(GeomShapeOf, ConvexGivesItsCorners) {
  const dReal planes[] = {1, 0, 0, .5, -1, 0, 0, .5, 0, 1, 0, 1, 0, -1, 0, 1, 0, 0, 1, 1.5, 0, 0, -1, 1.5};
  const dReal corners[] = {-.5, -1, -1.5, .5, -1, -1.5, -.5, 1, -1.5, .5, 1, -1.5,
                           -.5, -1, 1.5,  .5, -1, 1.5,  -.5, 1, 1.5,  .5, 1, 1.5};
  const unsigned faces[] = {4, 1, 3, 7, 5, 4, 0, 4, 6, 2, 4, 2, 6, 7, 3,
                            4, 0, 1, 5, 4, 4, 4, 5, 7, 6, 4, 0, 2, 3, 1};
  const dGeomID convex = dCreateConvex(nullptr, planes, 6, corners, 8, faces);
  place(convex);
  const GeomShape shape = read_geom(convex);
  dGeomDestroy(convex);
  EXPECT_EQ(shape.kind, GeomKind::convex);
  ASSERT_EQ(shape.vertices.size(), 8u);
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner(corners[3 * i], corners[3 * i + 1], corners[3 * i + 2]);
    EXPECT_TRUE(std::ranges::any_of(shape.vertices, [&](const Vec3& v) {
      return (v - corner).norm() < 1e-12;
    })) << corner.transpose();
  }
  EXPECT_EQ(shape.faces.size(), 12u);
  double volume = 0.0;
  for (const auto& [a, b, c] : shape.faces)
    volume += shape.vertices[a].dot(shape.vertices[b].cross(shape.vertices[c])) / 6.0;
  EXPECT_NEAR(volume, 6.0, 1e-12);
}

TEST_F(GeomShapeOf, TrimeshGivesItsFaces) {
  const float vertices[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const dTriIndex faces[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  const dTriMeshDataID data = dGeomTriMeshDataCreate();
  dGeomTriMeshDataBuildSingle(data, vertices, 3 * sizeof(float), 4, faces, 12, 3 * sizeof(dTriIndex));
  const dGeomID mesh = dCreateTriMesh(nullptr, data, nullptr, nullptr, nullptr);
  place(mesh);
  const dQuaternion askew = {0.9, 0.3, 0.2, 0.1};  // it is the same to the bit, however it stands
  dGeomSetQuaternion(mesh, askew);
  const GeomShape shape = read_geom(mesh);
  dGeomDestroy(mesh);
  dGeomTriMeshDataDestroy(data);
  ASSERT_EQ(shape.faces.size(), 4u);
  for (int i = 0; i < 12; ++i) {
    const float* const corner = vertices + 3 * faces[i];
    EXPECT_EQ(shape.vertices[std::size_t(i)], Vec3(corner[0], corner[1], corner[2]));
  }
  double volume = 0.0;
  for (const auto& [a, b, c] : shape.faces)
    volume += shape.vertices[a].dot(shape.vertices[b].cross(shape.vertices[c])) / 6.0;
  EXPECT_NEAR(volume, 1.0 / 6.0, 1e-6);
}

TEST_F(GeomShapeOf, RaysMeetBoxMeshAndHeightField) {
  const float vertices[] = {-5, -5, 0, 5, -5, 0, 5, 5, 0, -5, 5, 0};
  const dTriIndex faces[] = {0, 1, 2, 0, 2, 3};
  const dTriMeshDataID data = dGeomTriMeshDataCreate();
  dGeomTriMeshDataBuildSingle(data, vertices, 3 * sizeof(float), 4, faces, 6, 3 * sizeof(dTriIndex));
  const dGeomID mesh = dCreateTriMesh(nullptr, data, nullptr, nullptr, nullptr);
  dGeomSetPosition(mesh, 1e5, 0, 2);
  const dHeightfieldDataID heights = dGeomHeightfieldDataCreate();
  dGeomHeightfieldDataBuildCallback(
      heights, nullptr, [](void*, int x, int) { return dReal(x); }, 10, 10, 11, 11, 1, 0, 0, 0);
  const dGeomID field = dCreateHeightfield(nullptr, heights, 1);
  const dQuaternion upright = {std::sqrt(0.5), std::sqrt(0.5), 0, 0};  // ODE's height fields stand up along y
  dGeomSetQuaternion(field, upright);
  const dGeomID box = dCreateBox(nullptr, 2, 2, 2);

  GeomProbe probe;
  const auto on_box = probe.cast(box, {0.3, 0.2, 5}, -Vec3::UnitZ(), 10);
  ASSERT_TRUE(on_box);
  EXPECT_NEAR(on_box->distance, 4.0, 1e-12);
  EXPECT_EQ(on_box->normal, Vec3::UnitZ());
  EXPECT_FALSE(probe.cast(box, {0.3, 0.2, 5}, -Vec3::UnitZ(), 3.9));
  for (const double side : {1.0, -1.0}) {
    const auto on_mesh = probe.cast(mesh, {1e5 + 1.3, 0.7, 2 + 3 * side}, -side * Vec3::UnitZ(), 10);
    ASSERT_TRUE(on_mesh);
    EXPECT_NEAR(on_mesh->distance, 3.0, 1e-5);
    EXPECT_NEAR(on_mesh->normal.z(), side, 1e-6);
  }
  const auto on_field = probe.cast(field, {0.25, 0.4, 20}, -Vec3::UnitZ(), 30);
  ASSERT_TRUE(on_field);
  EXPECT_NEAR(on_field->point.z(), 5.25, 1e-9);  // the middle is sample 5
  EXPECT_NEAR(on_field->normal.dot(Vec3(-1, 0, 1).normalized()), 1.0, 1e-9);
  for (const dGeomID geom : {mesh, field, box}) dGeomDestroy(geom);
  dGeomTriMeshDataDestroy(data);
  dGeomHeightfieldDataDestroy(heights);
}

TEST_F(GeomShapeOf, CallersBodyIsReadAndPushed) {
  const dWorldID world = dWorldCreate();
  const dBodyID body = dBodyCreate(world);
  dMass mass;
  dMassSetBoxTotal(&mass, 6.0, 1, 2, 3);
  dBodySetMass(body, &mass);
  dBodyAddForce(body, 1, 2, 3);
  callers::add_force(body, {1, 1, 1}, {0, 0, 5});
  callers::set_state(body, {.position = {1, 2, 3}, .velocity = {4, 5, 6}, .angular_velocity = {7, 8, 9}});
  EXPECT_EQ(callers::mass(body), 6.0);
  EXPECT_TRUE(callers::inverse_inertia(body).isApprox(
      Vec3(1 / 6.5, 1 / 5.0, 1 / 2.5).asDiagonal().toDenseMatrix(), 1e-12));
  EXPECT_EQ(callers::force(body), Vec3(2, 3, 4));
  EXPECT_EQ(callers::torque(body), Vec3(0, 0, 5));
  EXPECT_EQ(callers::state(body).position, Vec3(1, 2, 3));
  EXPECT_EQ(callers::state(body).velocity, Vec3(4, 5, 6));
  EXPECT_EQ(callers::state(body).angular_velocity, Vec3(7, 8, 9));
  callers::set_enabled(body, false);
  EXPECT_FALSE(callers::is_enabled(body));
  EXPECT_FALSE(callers::is_kinematic(body));
  dWorldDestroy(world);
}

}  // namespace
}  // namespace lodestone
