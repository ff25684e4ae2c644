// Full bodies on a caller's height field: whatever their shape, dropped from two metres they rest on it and
// none sinks through.
#include <gtest/gtest.h>
#include <ode/ode.h>

#include <cmath>

#include "reference/random.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone::height_field_test {
namespace {

using namespace testing;

constexpr double kFrame = 1.0 / 60, kSide = 12.0;  // s, m
constexpr int kSamples = 25;

// A bowl with hills, so that nothing leaves it; `cell` counted from the corner.
dReal bowl(void*, int x, int z) {
  const double along = kSide * (x / double(kSamples - 1) - 0.5),
               across = kSide * (z / double(kSamples - 1) - 0.5);
  return 0.03 * (along * along + across * across) + 0.15 * std::cos(2.0 * along) * std::cos(1.7 * across);
}

struct Field {
  Field() {
    dInitODE2(0);
    dAllocateODEDataForThread(dAllocateMaskAll);
    world = dWorldCreate();
    space = dHashSpaceCreate(nullptr);
    dWorldSetGravity(world, 0, 0, -kGravity);
    data = dGeomHeightfieldDataCreate();
    dGeomHeightfieldDataBuildCallback(data, nullptr, bowl, kSide, kSide, kSamples, kSamples, 1, 0, 1, 0);
    dGeomHeightfieldDataSetBounds(data, -1, 4);
    geom = dCreateHeightfield(space, data, 1);
    const dQuaternion up = {std::sqrt(0.5), std::sqrt(0.5), 0, 0};  // y to z
    dGeomSetQuaternion(geom, up);
  }
  ~Field() {
    dSpaceDestroy(space);
    dWorldDestroy(world);
    dGeomHeightfieldDataDestroy(data);
  }
  Field(const Field&) = delete;
  Field& operator=(const Field&) = delete;

  // m, of the ground at (x, y); ODE's ray against it.
  double height(double x, double y) const {
    const dGeomID ray = dCreateRay(nullptr, 20.0);
    dGeomRaySet(ray, x, y, 10, 0, 0, -1);
    dContactGeom hit;
    const int hits = dCollide(ray, geom, 1, &hit, sizeof hit);
    dGeomDestroy(ray);
    EXPECT_EQ(hits, 1) << x << ' ' << y;
    return hits ? hit.pos[2] : 1e9;
  }

  dWorldID world;
  dSpaceID space;
  dHeightfieldDataID data;
  dGeomID geom;
};

class OnHeightField : public ::testing::TestWithParam<const char*> {
 protected:
  static std::shared_ptr<const Shape> shape(const std::string& name) {
    if (name == "ball") return std::make_shared<const Shape>(make_sphere_shape(0.18));
    if (name == "sphere_mesh") return std::make_shared<const Shape>(make_shape(name, make_sphere(0.18)));
    if (name == "box") return std::make_shared<const Shape>(make_shape(name, make_box({0.2, 0.3, 0.4})));
    if (name == "plate") return std::make_shared<const Shape>(make_shape(name, make_box({0.3, 0.3, 0.03})));
    return std::make_shared<const Shape>(make_shape(name, make_l(0.3, 0.2, 0.08, 0.1)));
  }
};

TEST_P(OnHeightField, WhatIsDroppedFromTwoMetresStaysOnIt) {
  const Field field;
  const MaterialTable materials = material(0.2, 0.6);
  OdeWorld world(field.world, field.space, OdeSettings{.auto_disable = true}, materials);
  const auto dropped = shape(GetParam());
  std::vector<OdeBodyId> bodies;
  for (int i = 0; i < 36; ++i) {
    RandomStream random(9, std::uint64_t(i), 0);
    const Vec3 place(1.3 * (i % 6) - 3.2, 1.25 * (i / 6) - 3.1, 0.0);
    RigidState s = at(place + Vec3(0, 0, field.height(place.x(), place.y()) + 2.0));
    s.orientation = random.orientation();
    bodies.push_back(world.add_body({.shape = dropped, .mass = 10.0, .state = s}));
  }
  for (int step = 0; step < 480; ++step) world.step(kFrame);
  for (const OdeBodyId body : bodies) {
    const RigidState s = world.state(body);
    double gap = 1e9;  // between its lowest corner and the ground
    if (dropped->sphere_radius)
      gap = s.position.z() - field.height(s.position.x(), s.position.y()) - *dropped->sphere_radius;
    else
      for (const Vec3& corner : dropped->hull.vertices) {
        const Vec3 point = s.position + s.orientation * corner;
        gap = std::min(gap, point.z() - field.height(point.x(), point.y()));
      }
    EXPECT_GT(gap, -0.02);
    EXPECT_LT(gap, 0.03);
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, OnHeightField,
                         ::testing::Values("ball", "sphere_mesh", "box", "plate", "corner"),
                         [](const auto& shape) { return std::string(shape.param); });

}  // namespace
}  // namespace lodestone::height_field_test
