#include "reference/ode/geometry_ode.h"

#include <gtest/gtest.h>

#include <numbers>

#include "reference/error.h"
#include "reference/ode/runtime_ode.h"
#include "tests/message_of.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone::ode {
namespace {

using testing::message_of;

class GeometryOfOde : public ::testing::Test {
 protected:
  GeometryOfOde() {
    prepare();
    world_ = dWorldCreate();
    space_ = dSimpleSpaceCreate(nullptr);
    body_ = dBodyCreate(world_);
  }
  ~GeometryOfOde() override {
    dSpaceDestroy(space_);
    dWorldDestroy(world_);
  }
  Eigen::AlignedBox3d bounds() const {
    Eigen::AlignedBox3d bounds;
    for (int i = 0; i < dSpaceGetNumGeoms(space_); ++i) {
      dReal box[6];
      dGeomGetAABB(dSpaceGetGeom(space_, i), box);
      bounds.extend(Vec3(box[0], box[2], box[4])), bounds.extend(Vec3(box[1], box[3], box[5]));
    }
    return bounds;
  }
  dWorldID world_;
  dSpaceID space_;
  dBodyID body_;
  TrimeshCache cache_;
};

// Each way of being met has the extent of the shape; a sphere in its place its volume.
TEST_F(GeometryOfOde, EveryGeometryIsAsLargeAsTheShape) {
  const auto box = lodestone::testing::box_shape({0.2, 0.4, 0.6});
  for (const OdeGeometry geometry : {OdeGeometry::trimesh, OdeGeometry::hull, OdeGeometry::box}) {
    dSpaceClean(space_);
    while (dSpaceGetNumGeoms(space_) > 0) dGeomDestroy(dSpaceGetGeom(space_, 0));
    const OdeBodyDefinition definition{.shape = box, .geometry = geometry};
    make_geoms(space_, body_, definition, spheres_of(definition), cache_);
    EXPECT_EQ(dSpaceGetNumGeoms(space_), 1);
    EXPECT_LT((bounds().sizes() - Vec3(0.2, 0.4, 0.6)).norm(), 1e-6);
    EXPECT_EQ(dGeomGetBody(dSpaceGetGeom(space_, 0)), body_);
  }
  const auto spheres = spheres_of({.shape = box, .geometry = OdeGeometry::sphere});
  ASSERT_EQ(spheres.size(), 1U);
  EXPECT_NEAR(4.0 / 3.0 * std::numbers::pi * std::pow(spheres[0].radius, 3), 0.2 * 0.4 * 0.6, 1e-12);
}

TEST_F(GeometryOfOde, SpheresStandWhereTheyAreGivenAndAreNumbered) {
  const auto box = lodestone::testing::box_shape({1, 1, 1});
  const std::vector<Sphere> given = {{{0.3, 0, 0}, 0.2}, {{0, 0, 0}, 0.1}, {{0, -0.4, 0.1}, 0.05}};
  const OdeBodyDefinition definition{.shape = box, .geometry = OdeGeometry::spheres, .spheres = given};
  make_geoms(space_, body_, definition, spheres_of(definition), cache_);
  dBodySetPosition(body_, 10, 20, 30);
  ASSERT_EQ(dSpaceGetNumGeoms(space_), 3);
  for (int i = 0; i < 3; ++i) {
    const dGeomID geom = dSpaceGetGeom(space_, i);
    const auto number = reinterpret_cast<std::uintptr_t>(dGeomGetData(geom));
    ASSERT_LT(number, 3U);
    EXPECT_EQ(dGeomSphereGetRadius(geom), given[number].radius);
    EXPECT_LT((to_vec3(dGeomGetPosition(geom)) - Vec3(10, 20, 30) - given[number].center).norm(), 1e-12);
  }
}

TEST_F(GeometryOfOde, ASphereIsASphereHoweverItIsAsked) {
  const auto ball = lodestone::testing::sphere_shape(0.3);
  for (const OdeGeometry geometry : {OdeGeometry::trimesh, OdeGeometry::hull, OdeGeometry::sphere}) {
    const auto spheres = spheres_of({.shape = ball, .geometry = geometry});
    ASSERT_EQ(spheres.size(), 1U);
    EXPECT_EQ(spheres[0].radius, 0.3);
    EXPECT_TRUE(spheres[0].center.isZero(0.0));
  }
}

// The data of a shape is made once, of its hull once more.
TEST_F(GeometryOfOde, BodiesOfAShapeShareItsTriangles) {
  const auto a = lodestone::testing::box_shape({1, 1, 1}), b = lodestone::testing::box_shape({1, 1, 1});
  EXPECT_EQ(cache_.mesh_of(a), cache_.mesh_of(a));
  EXPECT_NE(cache_.mesh_of(a), cache_.mesh_of(b));
  EXPECT_NE(cache_.mesh_of(a), cache_.hull_of(a));
  EXPECT_EQ(cache_.built(), 3);
}

TEST_F(GeometryOfOde, TrianglesOfShapesThatAreGoneAreForgotten) {
  std::weak_ptr<const Shape> first;
  for (int i = 0; i < 200; ++i) {
    const auto box = lodestone::testing::box_shape({1, 1, 1});
    cache_.mesh_of(box), cache_.hull_of(box);
    if (i == 0) first = box;
  }
  EXPECT_TRUE(first.expired());
  EXPECT_EQ(cache_.built(), 400);
}

TEST_F(GeometryOfOde, WhatOpcodeWouldCrashOnIsRefused) {
  Mesh mesh = make_box({1, 1, 1});
  const auto fault = [&] { return message_of([&] { TrimeshData(mesh.vertices, mesh.faces); }); };
  EXPECT_EQ(fault(), lodestone::testing::kNothingThrown);
  mesh.faces[4][2] = -1;
  EXPECT_EQ(fault(), "a trimesh: found a face of vertex -1, expected 0 … 7");
  mesh.faces[4][2] = 8;
  EXPECT_EQ(fault(), "a trimesh: found a face of vertex 8, expected 0 … 7");
  mesh = make_box({1, 1, 1});
  mesh.vertices[3].z() = INFINITY;
  EXPECT_TRUE(fault().ends_with("inf), expected finite ones")) << fault();
  mesh.faces.clear();
  EXPECT_EQ(fault(), "a trimesh: found 0 faces, expected two or more");
}

}  // namespace
}  // namespace lodestone::ode
