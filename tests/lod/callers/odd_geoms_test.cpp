// Geoms of a caller's that have no bounds, or no volume.
#include <gtest/gtest.h>
#include <ode/ode.h>

#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <vector>

#include "tests/lod/manager/manager_fixture.h"
#include "tests/prism.h"

namespace lodestone::odd_geoms_test {
namespace {

constexpr double kFrame = 1.0 / 60;

class OddGeoms : public ::testing::Test {
 protected:
  OddGeoms() {
    dInitODE2(0);
    dAllocateODEDataForThread(dAllocateMaskAll);
    world_ = dWorldCreate();
    space_ = dHashSpaceCreate(nullptr);
    dWorldSetGravity(world_, 0, 0, -9.81);
  }
  ~OddGeoms() override {
    manager_.reset();
    dSpaceDestroy(space_);
    dWorldDestroy(world_);
  }
  Manager& start() {
    manager_ = std::make_unique<Manager>(world_, space_,
                                         ManagerSettings{.signature_timing = SignatureTiming::in_step});
    return *manager_;
  }
  BodyId add_box(const Vec3& position, LevelChoice level) {
    static const auto box = std::make_shared<const Shape>(make_shape("box", make_box({0.3, 0.3, 0.3})));
    RigidState s;
    s.position = position;
    return manager_->add_body({.shape = box, .state = s, .level = level});
  }

  /// A body of two tons, .4 m high, which nothing pulls down; it stands on a floor of the caller's.
  dBodyID add_bed() const {
    dCreatePlane(space_, 0, 0, 1, 0);
    const dBodyID bed = dBodyCreate(world_);
    dGeomSetBody(dCreateBox(space_, 2, 2, 0.4), bed);
    dBodySetPosition(bed, 0, 0, 0.2);
    dBodySetGravityMode(bed, 0);
    dMass mass;
    dMassSetBoxTotal(&mass, 2000, 2, 2, 0.4);
    dBodySetMass(bed, &mass);
    return bed;
  }
  /// With its geoms, after the manager.
  void destroy(dBodyID body) {
    manager_.reset();
    while (const dGeomID geom = dBodyGetFirstGeom(body)) dGeomDestroy(geom);
    dBodyDestroy(body);
  }

  dWorldID world_;
  dSpaceID space_;
  std::unique_ptr<Manager> manager_;
};

dReal flat(void*, int, int) { return 0.0; }

TEST_F(OddGeoms, AHeightFieldThatRepeatsItselfIsGroundFarOutToo) {
  const dHeightfieldDataID data = dGeomHeightfieldDataCreate();
  dGeomHeightfieldDataBuildCallback(data, nullptr, flat, 4, 4, 9, 9, 1, 0, 1, 1);
  const dQuaternion up = {std::sqrt(0.5), std::sqrt(0.5), 0, 0};
  dGeomSetQuaternion(dCreateHeightfield(space_, data, 1), up);
  for (int i = 0; i < 40; ++i)
    dGeomSetPosition(dCreateBox(space_, 0.5, 0.5, 0.5), i - 20.0, 9.0,
                     0.2);  // so many that they are looked up in a tree
  Manager& manager = start();
  std::vector<BodyId> boxes;
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables})
    boxes.push_back(add_box({30.0 + 2.0 * double(boxes.size()), 5.1, 0.6}, level));
  for (int i = 0; i < 240; ++i) manager.step(kFrame);
  for (const BodyId body : boxes) EXPECT_NEAR(manager.state(body).position.z(), 0.15, 0.01);
  manager_.reset();
  dGeomHeightfieldDataDestroy(data);
}

// A valley of 80 × 80 cells of an eighth of a metre, its bottom along x = 0.
dReal valley(void* slope, int x, int) { return *static_cast<double*>(slope) * 0.125 * std::abs(x - 40); }

// Of its two sides only that below the centre was known: the ball went to and fro, the deeper the steeper
// they are, and at 60° out through the bottom.
TEST_F(OddGeoms, ABallInAValleyOfAHeightFieldTouchesBothSides) {
  constexpr double kRadius = 0.15;
  const auto ball = std::make_shared<const Shape>(make_sphere_shape(kRadius));
  for (double slope : {0.3, 1.0, 1.7}) {
    const dHeightfieldDataID data = dGeomHeightfieldDataCreate();
    dGeomHeightfieldDataBuildCallback(data, &slope, valley, 10, 10, 81, 81, 1, 0, 1, 0);
    const dGeomID field = dCreateHeightfield(space_, data, 1);
    const dQuaternion up = {std::sqrt(0.5), std::sqrt(0.5), 0, 0};
    dGeomSetQuaternion(field, up);
    Manager& manager = start();
    const double lies = kRadius * std::sqrt(1.0 + slope * slope);
    std::vector<BodyId> balls;
    for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables})
      balls.push_back(
          manager.add_body({.shape = ball,
                            .state = {.position = {0.01, 2.0 * double(balls.size()) - 2.03, lies + 0.02}},
                            .level = level}));
    for (int i = 0; i < 240; ++i) manager.step(kFrame);
    for (const BodyId body : balls) {
      EXPECT_NEAR(manager.state(body).position.z(), lies, 0.002) << slope;
      EXPECT_NEAR(manager.state(body).position.x(), 0.0, 0.002) << slope;
      EXPECT_TRUE(manager.asleep(body)) << slope;
    }
    manager_.reset();
    dGeomDestroy(field);
    dGeomHeightfieldDataDestroy(data);
  }
}

// Gravity along its own −y, as where the world's y is up.
TEST_F(OddGeoms, AHeightFieldWithoutAPlaceIsGroundAtTheOrigin) {
  dWorldSetGravity(world_, 0, -9.81, 0);
  const dHeightfieldDataID data = dGeomHeightfieldDataCreate();
  dGeomHeightfieldDataBuildCallback(data, nullptr, flat, 20, 20, 9, 9, 1, 0, 1, 0);
  dCreateHeightfield(space_, data, 0);
  Manager& manager = start();
  std::vector<BodyId> boxes;
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables})
    boxes.push_back(add_box({2.0 * double(boxes.size()), 0.6, 0.3}, level));
  for (int i = 0; i < 180; ++i) manager.step(kFrame);
  for (const BodyId box : boxes) EXPECT_NEAR(manager.state(box).position.y(), 0.15, 0.01);
  EXPECT_EQ(manager.report().counters.ode_messages, 0);
  const auto hit = manager.cast_ray({.from = {0, 5, 0}, .direction = {0, -1, 0}});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->point.y(), 0.0, 1e-9);
  manager_.reset();
  dGeomHeightfieldDataDestroy(data);
}

// Sleepers on it wake where it gets other data.
TEST_F(OddGeoms, AHeightFieldWithOtherHeightsIsAnother) {
  const dHeightfieldDataID high = dGeomHeightfieldDataCreate(), low = dGeomHeightfieldDataCreate();
  dGeomHeightfieldDataBuildCallback(high, nullptr, flat, 20, 20, 9, 9, 1, 0.5, 1, 0);
  dGeomHeightfieldDataBuildCallback(low, nullptr, flat, 20, 20, 9, 9, 1, 0.3, 1, 0);
  const dGeomID field = dCreateHeightfield(space_, high, 1);
  const dQuaternion up = {std::sqrt(0.5), std::sqrt(0.5), 0, 0};
  dGeomSetQuaternion(field, up);
  Manager& manager = start();
  std::vector<BodyId> boxes;
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables})
    boxes.push_back(add_box({2.0 * double(boxes.size()), 0, 0.7}, level));
  for (int i = 0; i < 180; ++i) manager.step(kFrame);
  for (const BodyId box : boxes) {
    EXPECT_TRUE(manager.asleep(box));
    EXPECT_NEAR(manager.state(box).position.z(), 0.65, 0.01);
  }
  dGeomHeightfieldSetHeightfieldData(field, low);
  for (int i = 0; i < 180; ++i) manager.step(kFrame);
  for (const BodyId box : boxes) EXPECT_NEAR(manager.state(box).position.z(), 0.45, 0.01);
  manager_.reset();
  dGeomHeightfieldDataDestroy(high), dGeomHeightfieldDataDestroy(low);
}

int meet_as_a_box(dGeomID own, dGeomID other, int flags, dContactGeom* contacts, int skip) {
  const dGeomID box = dCreateBox(nullptr, 8, 8, 8);
  const dReal* place = dGeomGetPosition(own);
  dGeomSetPosition(box, place[0], place[1], place[2]);
  const int count = dCollide(box, other, flags, contacts, skip);
  for (int i = 0; i < count; ++i)
    reinterpret_cast<dContactGeom*>(reinterpret_cast<char*>(contacts) + i * skip)->g1 = own;
  dGeomDestroy(box);
  return count;
}

void bounds_of_a_box(dGeomID own, dReal bounds[6]) {
  const dReal* place = dGeomGetPosition(own);
  for (int axis = 0; axis < 3; ++axis)
    bounds[2 * axis] = place[axis] - 4, bounds[2 * axis + 1] = place[axis] + 4;
}

// A class of his own is known by rays: these come from above, wherever that is.
TEST_F(OddGeoms, AnOwnClassHoldsWhicheverWayIsUp) {
  dGeomClass own_class{};
  own_class.collider = [](int) -> dColliderFn* { return meet_as_a_box; };
  own_class.aabb = bounds_of_a_box;
  static const int number = dCreateGeomClass(&own_class);
  const dGeomID own = dCreateGeom(number);
  dSpaceAdd(space_, own);
  for (const Vec3& up :
       {Vec3(Vec3::UnitZ()), Vec3(Vec3::UnitY()), Vec3(-Vec3::UnitX()), Vec3(-Vec3::UnitZ())}) {
    const Vec3 gravity = -9.81 * up, center = -4.0 * up;
    dWorldSetGravity(world_, gravity.x(), gravity.y(), gravity.z());
    dGeomSetPosition(own, center.x(), center.y(), center.z());
    for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables}) {
      Manager& manager = start();
      const BodyId box = add_box(0.5 * up, level);
      for (int i = 0; i < 120; ++i) manager.step(kFrame);
      EXPECT_NEAR(manager.state(box).position.dot(up), 0.15, 0.01) << up.transpose() << ' ' << int(level);
      manager_.reset();
    }
  }
}

// m, of a bowl about the middle of 81 × 81 samples that are .1 m apart.
dReal bowl(void*, int x, int z) { return 2e-4 * ((x - 40) * (x - 40) + (z - 40) * (z - 40)); }

// Any of its many corners may be what touches there.
TEST_F(OddGeoms, ARoundBodyComesToRestInABowlOfAHeightField) {
  const dHeightfieldDataID data = dGeomHeightfieldDataCreate();
  dGeomHeightfieldDataBuildCallback(data, nullptr, bowl, 8, 8, 81, 81, 1, 0, 1, 0);
  const dQuaternion up = {std::sqrt(0.5), std::sqrt(0.5), 0, 0};
  dGeomSetQuaternion(dCreateHeightfield(space_, data, 1), up);
  for (const int sides : {12, 24}) {
    Manager manager(world_, space_, {.signatures = testing::no_signature});
    std::vector<BodyId> bodies;
    for (int i = 0; i < 4; ++i) {
      RigidState s;
      s.position = {i % 2 - 0.6, i / 2 - 0.4, 0.6};
      s.orientation = Quat(Eigen::AngleAxisd(0.5 + i, Vec3(1.0, 0.3 * i, 0.2).normalized()));
      bodies.push_back(manager.add_body(
          {.shape = testing::make_prism(sides, 0.15, 0.5), .state = s, .level = LevelChoice::support}));
    }
    // In ODE the last of those with 24 sides does so after 18 s.
    for (int i = 0; i < 1200; ++i) manager.step(kFrame);
    for (const BodyId body : bodies) EXPECT_TRUE(manager.asleep(body)) << sides;
  }
  dGeomHeightfieldDataDestroy(data);
}

// m, of waves of about .4 m on 161 × 161 samples that are .1 m apart.
dReal waves(void*, int x, int z) {
  constexpr double kTurn = 2.0 * std::numbers::pi * 0.1;  // rad, of a sample, over the length in m
  return 0.01 * std::sin(kTurn / 0.33 * x) * std::cos(kTurn / 0.43 * z);
}

// In ODE in steps of 1/960 s 3.0 m in eight seconds.
TEST_F(OddGeoms, ABarrelRollsOverAHeightField) {
  const dHeightfieldDataID data = dGeomHeightfieldDataCreate();
  dGeomHeightfieldDataBuildCallback(data, nullptr, waves, 16, 16, 161, 161, 1, 0, 1, 0);
  const dQuaternion up = {std::sqrt(0.5), std::sqrt(0.5), 0, 0};
  dGeomSetQuaternion(dCreateHeightfield(space_, data, 1), up);
  Manager manager(world_, space_, {.signatures = testing::no_signature});
  manager.materials().replace(0, {.restitution = 0.2, .friction = 0.5});
  double sum = 0.0;
  for (int i = 0; i < 4; ++i) {
    RigidState s;
    s.position = {-5, 0, 0.135};
    s.orientation = Quat(Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitX()) *
                         Eigen::AngleAxisd(0.4 * i, Vec3::UnitZ()));
    s.velocity.x() = 1.5;
    s.angular_velocity.y() = 12.5;
    const BodyId body = manager.add_body(
        {.shape = testing::make_prism(24, 0.12, 0.3), .state = s, .level = LevelChoice::support});
    for (int frame = 0; frame < 480; ++frame) manager.step(kFrame);
    sum += manager.state(body).position.x() + 5;
    manager.remove_body(body);
  }
  EXPECT_NEAR(sum / 4, 3.0, 0.4);
  dGeomHeightfieldDataDestroy(data);
}

// A sheet that has two sides, divided into triangles in two ways: full bodies lay on the caller's, others
// fell through, and as the manager's it was refused.
TEST_F(OddGeoms, AClosedSheetHoldsOnEachRung) {
  const Mesh sheet{{{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}},
                   {{0, 1, 2}, {0, 2, 3}, {3, 1, 0}, {3, 2, 1}}};
  std::vector<double> corners;
  std::vector<dTriIndex> indices;
  for (const Vec3& v : sheet.vertices) corners.insert(corners.end(), {v.x(), v.y(), v.z()});
  for (const auto& f : sheet.faces)
    for (const int i : f) indices.push_back(dTriIndex(i));
  const dTriMeshDataID data = dGeomTriMeshDataCreate();
  dGeomTriMeshDataBuildDouble(data, corners.data(), 3 * sizeof(double), 4, indices.data(),
                              int(indices.size()), 3 * sizeof(dTriIndex));
  for (const bool of_caller : {true, false}) {
    const dGeomID geom = of_caller ? dCreateTriMesh(space_, data, nullptr, nullptr, nullptr) : nullptr;
    start();
    if (!of_caller) manager_->add_static_mesh(sheet);
    std::vector<BodyId> bodies;
    for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables})
      bodies.push_back(add_box({0.8 * double(bodies.size()) - 0.9, 0.1, 0.5}, level));
    testing::run(*manager_, 2.0);
    for (const BodyId body : bodies)
      EXPECT_NEAR(manager_->state(body).position.z(), 0.15, 0.01) << body.index << of_caller;
    manager_.reset();
    if (geom) dGeomDestroy(geom);
  }
  dGeomTriMeshDataDestroy(data);
}

TEST_F(OddGeoms, ABodyWithAFlatTrimeshIsNoError) {
  static const float corners[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  static const dTriIndex faces[] = {0, 1, 2, 0, 2, 3};
  const dTriMeshDataID data = dGeomTriMeshDataCreate();
  dGeomTriMeshDataBuildSingle(data, corners, 3 * sizeof(float), 4, faces, 6, 3 * sizeof(dTriIndex));
  const dBodyID sheet = dBodyCreate(world_);
  dGeomSetBody(dCreateTriMesh(space_, data, nullptr, nullptr, nullptr), sheet);
  dBodySetPosition(sheet, 0, 0, 3);
  Manager& manager = start();
  manager.add_plane(Vec3::UnitZ(), 0.0);
  const BodyId box = add_box({5, 0, 0.6}, LevelChoice::support);
  for (int i = 0; i < 120; ++i) ASSERT_NO_THROW(manager.step(kFrame));
  EXPECT_NEAR(manager.state(box).position.z(), 0.15, 0.01);
  EXPECT_LT(dBodyGetPosition(sheet)[2], 3.0);
  manager_.reset();
  dGeomDestroy(dBodyGetFirstGeom(sheet));
  dBodyDestroy(sheet);
  dGeomTriMeshDataDestroy(data);
}

// A sign on a truck: the truck is met all the same.
TEST_F(OddGeoms, AFlatGeomLeavesTheOthersOfItsBodySolid) {
  static const float corners[] = {-1, 0, 0, 1, 0, 0, 1, 0, 1, -1, 0, 1};
  static const dTriIndex faces[] = {0, 1, 2, 0, 2, 3};
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables}) {
    const dTriMeshDataID data = dGeomTriMeshDataCreate();
    dGeomTriMeshDataBuildSingle(data, corners, 3 * sizeof(float), 4, faces, 6, 3 * sizeof(dTriIndex));
    const dBodyID truck = add_bed();
    const dGeomID sign = dCreateTriMesh(space_, data, nullptr, nullptr, nullptr);
    dGeomSetBody(sign, truck);
    dGeomSetOffsetPosition(sign, 0, 0.9, 0.2);
    Manager& manager = start();
    const BodyId crate = add_box({0, 0, 0.56}, level);
    for (int i = 0; i < 60; ++i) manager.step(kFrame);
    EXPECT_NEAR(manager.state(crate).position.z(), 0.55, 0.02);
    destroy(truck);
    dGeomTriMeshDataDestroy(data);
  }
}

// What lay on the geom falls onto the next one: nothing that is known of the body as it was holds it.
TEST_F(OddGeoms, WhatLiesOnAGeomThatIsDestroyedFalls) {
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables}) {
    const dBodyID rack = add_bed();
    const dGeomID shelf = dCreateBox(space_, 1, 1, 0.1);
    dGeomSetBody(shelf, rack);
    dGeomSetOffsetPosition(shelf, 0, 0, 1);
    Manager& manager = start();
    const BodyId crate = add_box({0, 0, 1.4}, level);
    for (int i = 0; i < 6; ++i) manager.step(kFrame);
    EXPECT_NEAR(manager.state(crate).position.z(), 1.4, 0.01);
    dGeomDestroy(shelf);
    for (int i = 0; i < 90; ++i) manager.step(kFrame);
    EXPECT_NEAR(manager.state(crate).position.z(), 0.55, 0.02);
    destroy(rack);
  }
}

// What the caller made of one of his geoms that is no number is left out, until it is one again; the others,
// and what lies on them, go on as if it were not there.
TEST_F(OddGeoms, OneThatIsNoNumberIsLeftOutAndOthersNeverNotice) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const dMatrix3 turned = {kNan, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  const std::function<void(dGeomID)> spoils[] = {
      [](dGeomID geom) { dGeomSetPosition(geom, kNan, 0, 0); },
      [](dGeomID geom) { dGeomSetPosition(geom, 0, 0, std::numeric_limits<double>::infinity()); },
      [&](dGeomID geom) { dGeomSetRotation(geom, turned); },
      [](dGeomID geom) { dGeomDestroy(geom); }};  // how it ought to be
  dCreatePlane(space_, 0, 0, 1, 0);
  std::vector<std::vector<RigidState>> ends;
  for (const auto& spoil : spoils) {
    const dGeomID beside = dCreateBox(space_, 1, 1, 1);
    dGeomSetPosition(beside, 5, 0, 0.5);
    Manager& manager = start();
    std::vector<BodyId> boxes;
    for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables})
      boxes.push_back(add_box({2.0 * double(boxes.size()), 0, 0.6}, level));
    for (int i = 0; i < 10; ++i) manager.step(kFrame);
    spoil(beside);
    for (int i = 0; i < 90; ++i) manager.step(kFrame);
    std::vector<RigidState>& end = ends.emplace_back();
    for (const BodyId box : boxes) end.push_back(manager.state(box));
    manager_.reset();
    if (&spoil != &spoils[3]) dGeomDestroy(beside);
  }
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(ends[i][k].position, ends[3][k].position) << i << ' ' << k;
      EXPECT_NEAR(ends[i][k].position.z(), 0.15, 0.02);
    }
}

}  // namespace
}  // namespace lodestone::odd_geoms_test
