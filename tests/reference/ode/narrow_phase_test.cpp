// Trimesh–trimesh contacts of boxes against the exact least displacement (separating axes).
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "reference/ode/geometry_ode.h"
#include "reference/ode/narrow_phase_ode.h"
#include "reference/random.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

struct BoxPair {
  Vec3 half;
  Quat orientation;  // of the first; the second stands straight at the origin
  Vec3 direction;    // in which the first is away from the second

  double reach(const Quat& q, const Vec3& axis) const { return (q.conjugate() * axis).cwiseAbs().dot(half); }

  /// The least distance along any separating axis that the first, `distance` away, must move to be clear.
  double depth_at(double distance) const {
    double least = std::numeric_limits<double>::infinity();
    const auto try_axis = [&](const Vec3& raw) {
      if (raw.norm() < 1e-6) return;
      const Vec3 axis = raw.normalized();
      least = std::min(least, reach(orientation, axis) + reach(Quat::Identity(), axis) -
                                  distance * std::abs(direction.dot(axis)));
    };
    for (int i = 0; i < 3; ++i) {
      try_axis(Vec3::Unit(i)), try_axis(orientation * Vec3::Unit(i));
      for (int j = 0; j < 3; ++j) try_axis(Vec3::Unit(i).cross(orientation * Vec3::Unit(j)));
    }
    return least;
  }

  double distance_for(double depth) const {
    double near = 0.0, far = 4.0 * half.norm();
    for (int i = 0; i < 60; ++i) (depth_at(0.5 * (near + far)) > depth ? near : far) = 0.5 * (near + far);
    return near;
  }
};

class BoxOracle : public ::testing::TestWithParam<double> {};

// Hard case F9. Where an edge meets an edge ODE's places alone may leave a little too much: see the second
// bound.
TEST_P(BoxOracle, ContactsAreNoDeeperThanTheTruth) {
  ode::prepare();
  const double depth = GetParam();
  const Vec3 sides(0.6, 0.8, 1.0);
  const Mesh box = make_box(sides);
  const ode::TrimeshData data(box.vertices, box.faces);
  const dGeomID first = dCreateTriMesh(nullptr, data.id(), nullptr, nullptr, nullptr);
  const dGeomID second = dCreateTriMesh(nullptr, data.id(), nullptr, nullptr, nullptr);
  ode::NarrowPhase narrow_phase;
  std::vector<ContactPoint> found;
  int too_deep = 0;
  constexpr int kPoses = 300;
  for (std::uint32_t pose = 0; pose < kPoses; ++pose) {
    RandomStream random(3, pose, 0);
    const BoxPair pair{0.5 * sides, random.orientation(), random.direction()};
    const Vec3 position = pair.distance_for(depth) * pair.direction;
    const dQuaternion q = {pair.orientation.w(), pair.orientation.x(), pair.orientation.y(),
                           pair.orientation.z()};
    dGeomSetPosition(first, position.x(), position.y(), position.z());
    dGeomSetQuaternion(first, q);
    found.clear();
    narrow_phase.find(first, second, 0.5 * sides.norm(), found);
    ASSERT_FALSE(found.empty()) << "pose " << pose;
    const double deepest = std::ranges::max(found, {}, &ContactPoint::depth).depth;
    EXPECT_LT(deepest, depth + 1e-2) << "pose " << pose;
    too_deep += deepest > depth + 2.5e-3;
    for (const ContactPoint& contact : found) EXPECT_NEAR(contact.normal.norm(), 1.0, 1e-6);
  }
  EXPECT_LE(too_deep, kPoses * 3 / 100);
  dGeomDestroy(first), dGeomDestroy(second);
}

INSTANTIATE_TEST_SUITE_P(NarrowPhase, BoxOracle, ::testing::Values(1e-4, 1e-3, 5e-3));

// Over an edge ODE calls a triangle's normal the contact's.
TEST(NarrowPhase, ABallOverAnEdgeIsPushedToItsCentre) {
  const MaterialTable materials;
  OdeWorld world({.gravity = Vec3::Zero()}, materials);
  const auto cube = std::make_shared<const Shape>(make_shape("cube", make_box(Vec3::Constant(0.3))));
  const auto ball = std::make_shared<const Shape>(make_sphere_shape(0.5));
  const Vec3 out = Vec3(-0.9, 0.0, 0.4).normalized();
  world.add_body(
      {.shape = ball, .mass = 2000.0, .state = {.position = Vec3(-0.15, 0.02, 0.15) + 0.499 * out}});
  world.add_body({.shape = cube, .mass = 10.0});
  world.step(1e-5);
  ASSERT_EQ(world.contacts().size(), 1u);
  const OdeContact& contact = world.contacts().front();
  EXPECT_GT(std::abs(contact.normal.dot(out)), 0.9999);
  EXPECT_NEAR(contact.depth, 1e-3, 1e-4);
}

// Its contacts with the wall were turned to the floor's: along an upright sheet no way out is found.
TEST(NarrowPhase, NothingPassesAWallOfTheMeshThatItSlidesOn) {
  const MaterialTable table = material(0.4, 0.1);
  Mesh corner;  // floor z = 0, wall x = 0
  corner.vertices = {{-4, -2, 0}, {0, -2, 0}, {0, 2, 0}, {-4, 2, 0}, {0, -2, 2}, {0, 2, 2}};
  corner.faces = {{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 2}};
  for (const double speed : {2.0, 4.0, 12.0})
    for (const double turn : {0.0, 0.3, 0.7}) {
      OdeWorld world({}, table);
      world.add_static_mesh(corner, 0);
      const OdeBodyId cube = world.add_body(
          {.shape = box_shape(Vec3::Constant(0.2)),
           .mass = 8.0,
           .state = at({-0.6, 0, 0.1}, {speed, 0, 0}, Vec3::Zero(), rotation_from_vector({0, 0, turn}))});
      for (int i = 0; i < 240; ++i) world.step(1.0 / 240.0);
      EXPECT_LT(world.state(cube).position.x(), 0.0) << speed << " m/s, turned by " << turn;
    }
}

}  // namespace
}  // namespace lodestone
