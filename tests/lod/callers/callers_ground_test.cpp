#include "lod/callers/callers_ground.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "reference/random.h"
#include "tests/lod/callers/callers_scene.h"

namespace lodestone {
namespace {

constexpr double kCallersStep = 1.0 / 60;

class GroundOfCaller : public ::testing::Test {
 protected:
  void follow() {
    disturbed_.clear(), planes_.clear();
    scene_.mirror->refresh();
    const auto note = [this](const Eigen::AlignedBox3d& box) { disturbed_.push_back(box); };
    callers_.follow(*scene_.mirror, kCallersStep, kCallersStep, Vec3::UnitZ(),
                    {.disturbed = note, .gone = note, .came = [this](const HalfSpace& plane) {
                       planes_.push_back(plane);
                     }});
  }
  /// The geoms of the parts that come within a metre of a place.
  std::multiset<dGeomID> near(const Vec3& place) const {
    std::vector<const GroundPart*> parts;
    ground_.find_parts(place, 1.0, parts);
    std::multiset<dGeomID> geoms;
    for (const GroundPart* part : parts) geoms.insert(callers_.geom_of(part->id));
    return geoms;
  }
  const GroundPart& part_at(const Vec3& place) const {
    std::vector<const GroundPart*> parts;
    ground_.find_parts(place, 0.5, parts);
    EXPECT_EQ(parts.size(), 1U);
    return *parts.at(0);
  }
  bool is_disturbed(const Vec3& place) const {
    for (const Eigen::AlignedBox3d& box : disturbed_)
      if (box.contains(place)) return true;
    return false;
  }
  testing::CallersScene scene_;
  Ground ground_;
  CallersGround callers_{ground_};
  std::vector<Eigen::AlignedBox3d> disturbed_;
  std::vector<HalfSpace> planes_;  // that came
};

// Whatever came, went and moved: the ground's parts are his geoms, where they are.
TEST_F(GroundOfCaller, IsWhatHisSpaceHolds) {
  RandomStream random(5, 0, 0);
  std::vector<std::pair<dGeomID, Vec3>> there;
  for (int round = 0; round < 40; ++round) {
    for (int k = 0; k < 3; ++k) {
      const Vec3 place(random.uniform(-20, 20), random.uniform(-20, 20), 0);
      if (random.uniform() < 0.5 || there.empty()) {
        there.emplace_back(scene_.box({1, 1, 1}, place), place);
        continue;
      }
      auto& [geom, at] = there[std::size_t(random.uniform(0, double(there.size())))];
      if (random.uniform() < 0.5) {
        dGeomSetPosition(geom, place.x(), place.y(), place.z()), at = place;
      } else {
        dGeomDestroy(geom);
        std::erase_if(there, [gone = geom](const auto& entry) { return entry.first == gone; });
      }
    }
    follow();
    ASSERT_EQ(ground_.parts(), there.size());
    for (const auto& [geom, at] : there) EXPECT_TRUE(near(at).contains(geom));
  }
}

// A manager that is restored first sees it as it is turned by then: what its bounds leave out is to be the
// same, or it goes on otherwise.
TEST_F(GroundOfCaller, ABoxHasTheSameBoundsHoweverItIsTurnedWhenFirstSeen) {
  const dGeomID box = scene_.box({2, 1, 0.5}, {3, 0, 0});
  dMatrix3 turned;
  dRFromAxisAndAngle(turned, 1, 2, 3, 0.7);
  dGeomSetRotation(box, turned);
  follow();
  const Eigen::AlignedBox3d bounds = part_at({3, 0, 0}).shape.bounds;
  EXPECT_EQ(bounds.min(), Vec3(-1, -0.5, -0.25));
  EXPECT_EQ(bounds.max(), Vec3(1, 0.5, 0.25));
}

TEST_F(GroundOfCaller, PlanesAreHalfSpaces) {
  const dGeomID plane = dCreatePlane(scene_.space, 0, 0, 1, 0.5);
  follow();
  ASSERT_EQ(planes_.size(), 1u);
  EXPECT_EQ(planes_[0].offset, 0.5);
  ASSERT_EQ(ground_.planes().size(), 1U);
  EXPECT_EQ(ground_.planes()[0].height_of({3, 4, 2}), 1.5);
  EXPECT_EQ(callers_.geom_of(ground_.id_of_plane(0)), plane);
  dGeomPlaneSetParams(plane, 1, 0, 0, -2);
  follow();
  EXPECT_EQ(ground_.planes()[0].height_of({3, 4, 2}), 5.0);
  EXPECT_TRUE(is_disturbed({1e6, 1e6, 1e6}));  // all that lies anywhere
  dGeomDestroy(plane);
  follow();
  EXPECT_TRUE(ground_.planes().empty());
  EXPECT_TRUE(is_disturbed({0, 0, 0}));
}

TEST_F(GroundOfCaller, WhereSomethingCameWentOrMovedIsDisturbed) {
  const dGeomID box = scene_.box({1, 1, 1}, {0, 0, 0}), still = scene_.box({1, 1, 1}, {9, 0, 0});
  follow();
  EXPECT_TRUE(is_disturbed({0, 0, 0}) && is_disturbed({9, 0, 0}));
  follow();
  EXPECT_TRUE(disturbed_.empty());
  dGeomSetPosition(box, 0.1, 0, 0);
  follow();
  EXPECT_TRUE(is_disturbed({-0.45, 0, 0}) && is_disturbed({0.55, 0, 0}));
  EXPECT_FALSE(is_disturbed({9, 0, 0}));
  dGeomDestroy(still);
  follow();
  EXPECT_TRUE(is_disturbed({9, 0, 0}));
}

// What he puts elsewhere from step to step has the velocity of that, for that step alone; a leap has none.
TEST_F(GroundOfCaller, WhatHePutsElsewhereCarries) {
  const dGeomID box = scene_.box({1, 1, 1}, {0, 0, 0});
  follow();
  EXPECT_FALSE(part_at({0, 0, 0}).moves());
  dGeomSetPosition(box, 0.02, 0, 0.01);
  follow();
  EXPECT_LT((part_at({0, 0, 0}).pose.velocity - Vec3(1.2, 0, 0.6)).norm(), 1e-9);
  follow();
  EXPECT_FALSE(part_at({0, 0, 0}).moves());
  dQuaternion turned = {std::cos(0.01), 0, 0, std::sin(0.01)};
  dGeomSetQuaternion(box, turned);
  follow();
  EXPECT_LT((part_at({0, 0, 0}).pose.angular_velocity - Vec3(0, 0, 0.02 * 60)).norm(), 1e-6);
  dGeomSetPosition(box, 500, 0, 0);
  follow();
  EXPECT_FALSE(part_at({500, 0, 0}).moves());
}

// So has what turns, but for a great one whose rim would be beyond all speeds.
TEST_F(GroundOfCaller, ATurnThatIsALeapHasNoVelocity) {
  const dGeomID door = scene_.box({2, 0.1, 2}, {0, 0, 0}), fan = scene_.box({0.4, 0.4, 0.1}, {5, 0, 0});
  const dQuaternion a_quarter = {std::sqrt(0.5), 0, 0, std::sqrt(0.5)};
  follow();
  dGeomSetQuaternion(door, a_quarter), dGeomSetQuaternion(fan, a_quarter);
  follow();
  EXPECT_FALSE(part_at({0, 0, 0}).moves());
  EXPECT_LT((part_at({5, 0, 0}).pose.angular_velocity - Vec3(0, 0, 30 * std::numbers::pi)).norm(), 1e-6);
}

// A kinematic body's geoms are ground that goes on as the body does; a dynamic body's are none.
TEST_F(GroundOfCaller, KinematicBodiesCarryAndDynamicOnesAreNoGround) {
  const dBodyID lift = scene_.body(1.0, {0, 0, 0}), ball = scene_.body(1.0, {5, 0, 0});
  dBodySetKinematic(lift);
  dBodySetLinearVel(lift, 0, 0, 2);
  dBodySetAngularVel(lift, 0, 0, 1);
  follow();
  ASSERT_EQ(ground_.parts(), 1U);
  EXPECT_LT((part_at({0, 0, 0}).velocity_at({0.2, 0, 0}) - Vec3(0, 0.2, 2)).norm(), 1e-12);
  EXPECT_EQ(part_at({0, 0, 0}).pose.goes_on_s, kCallersStep);
  dBodySetLinearVel(lift, 0, 0, 0), dBodySetAngularVel(lift, 0, 0, 0);
  follow();
  EXPECT_FALSE(part_at({0, 0, 0}).moves());
  dBodySetDynamic(lift);
  dBodySetKinematic(ball);
  follow();
  ASSERT_EQ(ground_.parts(), 1U);
  EXPECT_TRUE(near({5, 0, 0}).size() == 1 && near({0, 0, 0}).empty());
}

TEST_F(GroundOfCaller, GroundThatIsNoneOfHisHasNoGeom) {
  const GroundId own = ground_.add_plane({});
  scene_.box({1, 1, 1}, {0, 0, 0});
  follow();
  EXPECT_EQ(callers_.geom_of(own), nullptr);
  EXPECT_EQ(callers_.geom_of({}), nullptr);
  EXPECT_EQ(callers_.geom_of({99, 1}), nullptr);
}

}  // namespace
}  // namespace lodestone
