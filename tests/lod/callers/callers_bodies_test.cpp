#include "lod/callers/callers_bodies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <vector>

#include "tests/lod/callers/callers_scene.h"

namespace lodestone {
namespace {

class BodiesOfCaller : public ::testing::Test {
 protected:
  void follow() {
    scene_.mirror->refresh();
    callers_.follow(
        *scene_.mirror, [this](const Eigen::AlignedBox3d& box) { left_.push_back(box); },
        [this](std::uint32_t owner, const GroundBits& bits) { bits_[owner] = bits; });
  }
  std::vector<FullNeighbor> gather() {
    std::vector<FullNeighbor> neighbors;
    contacts_.clear();
    callers_.gather(ground_, {0, 0, -9.81}, neighbors, contacts_);
    return neighbors;
  }
  /// Of all neighbours that of this body.
  FullNeighbor& of(std::vector<FullNeighbor>& neighbors, dBodyID body) const {
    return *std::ranges::find_if(neighbors,
                                 [&](const FullNeighbor& n) { return callers_.body_of(n.owner) == body; });
  }
  static Vec3 velocity(dBodyID body) {
    const dReal* v = dBodyGetLinearVel(body);
    return {v[0], v[1], v[2]};
  }
  testing::CallersScene scene_;
  Ground ground_;
  CallersBodies callers_;
  std::vector<FullContact> contacts_;
  std::vector<Eigen::AlignedBox3d> left_;
  std::map<std::uint32_t, GroundBits> bits_;
};

TEST_F(BodiesOfCaller, HaveTheBitsOfAllTheirGeoms) {
  const dBodyID body = scene_.body(2.0, {1, 2, 3});
  dGeomSetCategoryBits(dBodyGetFirstGeom(body), 2), dGeomSetCollideBits(dBodyGetFirstGeom(body), 4);
  follow();
  const std::uint32_t owner = gather().front().owner;
  ASSERT_TRUE(bits_.contains(owner));
  EXPECT_EQ(bits_[owner].category, 2U);
  EXPECT_EQ(bits_[owner].collide, 4U);
  dGeomSetCategoryBits(dBodyGetFirstGeom(body), 8);
  follow();
  EXPECT_EQ(bits_[gather().front().owner].category, 8U);
}

TEST_F(BodiesOfCaller, AreNeighboursAsTheyAreNow) {
  const dBodyID a = scene_.body(2.0, {1, 2, 3}), b = scene_.body(5.0, {4, 0, 1});
  dBodySetLinearVel(a, 1, 0, 0), dBodyAddForce(a, 0, 7, 0), dBodyDisable(b);
  follow();
  EXPECT_EQ(callers_.size(), 2U);
  std::vector<FullNeighbor> n = gather();
  ASSERT_EQ(n.size(), 2U);
  const FullNeighbor& first = of(n, a);
  EXPECT_EQ(first.mass, 2.0);
  EXPECT_EQ(first.state.position, Vec3(1, 2, 3));
  EXPECT_EQ(first.state.velocity, Vec3(1, 0, 0));
  EXPECT_EQ(first.force, Vec3(0, 7, 0));
  EXPECT_FALSE(first.asleep);
  EXPECT_TRUE(of(n, b).asleep);
  EXPECT_NEAR(first.shape->radius, 0.2 * std::sqrt(3.0), 1e-9);
  EXPECT_EQ(callers_.body_of(3), nullptr);
  dBodySetGravityMode(a, 0);
  n = gather();
  EXPECT_LT((of(n, a).force - Vec3(0, 7, 2 * 9.81)).norm(), 1e-12);  // as if held up
}

// Impulses come back at once, pushes as a force over the step; a sleeper that was not woken is left alone.
TEST_F(BodiesOfCaller, WhatTheyAreGivenArrives) {
  const dBodyID a = scene_.body(2.0, {0, 0, 0}), b = scene_.body(2.0, {4, 0, 0}),
                c = scene_.body(2.0, {8, 0, 0});
  dBodySetLinearVel(a, 0, 1, 0), dBodyDisable(b), dBodyDisable(c);
  follow();
  std::vector<FullNeighbor> n = gather();
  of(n, a).hit = {{6, 0, 0}, {0, 0, 0.1}};
  of(n, a).push = {{0, 0, 3}, {0, 0, 0}};
  of(n, b).asleep = false;  // a hit woke it
  of(n, b).hit = {{0, 0, 4}, Vec3::Zero()};
  of(n, c).hit = {{9, 9, 9}, Vec3::Zero()};
  for (FullNeighbor& each : n) each.touches_full = true;
  callers_.hand_over(n, Vec3(0, 0, -9.81), 0.5, 4);
  EXPECT_LT((velocity(a) - Vec3(3, 1, 0)).norm(), 1e-12);
  const double inertia = 2.0 * 0.4 * 0.4 / 6.0;
  EXPECT_NEAR(dBodyGetAngularVel(a)[2], 0.1 / inertia, 1e-9);
  EXPECT_NEAR(dBodyGetForce(a)[2], 6.0, 1e-12);
  EXPECT_TRUE(dBodyIsEnabled(b));
  EXPECT_LT((velocity(b) - Vec3(0, 0, 2)).norm(), 1e-12);
  EXPECT_FALSE(dBodyIsEnabled(c));
  EXPECT_EQ(velocity(c), Vec3(Vec3::Zero()));
}

TEST_F(BodiesOfCaller, WhatHoldsThemUpIsAmongTheContacts) {
  ground_.add_plane({.bits = {.callers = true}});
  ground_.add_plane({.offset = 0.1});  // the manager's, which the caller's bodies do not meet
  const dBodyID stands = scene_.body(2.0, {0, 0, 0.2});
  scene_.body(2.0, {5, 0, 3});
  follow();
  const std::vector<FullNeighbor> n = gather();
  EXPECT_EQ(contacts_.size(), 4U);  // the corners of the one that stands there
  for (const FullContact& contact : contacts_) {
    EXPECT_EQ(callers_.body_of(n[std::size_t(contact.first)].owner), stands);
    EXPECT_EQ(contact.second, -1);
    EXPECT_EQ(contact.normal, Vec3(0, 0, 1));
    EXPECT_NEAR(contact.point.z(), 0.0, 1e-9);
    EXPECT_NEAR(contact.gap, 0.0, 1e-9);
  }
}

// As they come and go: those that are there, each with an owner of its own for as long as it is.
TEST_F(BodiesOfCaller, ComeAndGo) {
  std::vector<dBodyID> there = {scene_.body(1, {0, 0, 0}), scene_.body(2, {2, 0, 0}),
                                scene_.body(3, {4, 0, 0})};
  follow();
  std::vector<FullNeighbor> before = gather();
  std::vector<std::uint32_t> owners;
  for (const dBodyID body : there) owners.push_back(of(before, body).owner);
  const dBodyID late = scene_.body(4, {6, 0, 0});
  dGeomDestroy(dBodyGetFirstGeom(there[1]));
  dBodyDestroy(there[1]);
  follow();
  std::vector<FullNeighbor> after = gather();
  ASSERT_EQ(after.size(), 3U);
  EXPECT_EQ(of(after, there[0]).owner, owners[0]);
  EXPECT_EQ(of(after, there[2]).owner, owners[2]);
  EXPECT_EQ(of(after, late).mass, 4.0);
  EXPECT_EQ(std::ranges::count(owners, of(after, late).owner), 0);
  EXPECT_EQ(callers_.body_of(owners[1]), nullptr);
}

// Where one was that has gone, or was put elsewhere; not where one moves on a little.
TEST_F(BodiesOfCaller, WhatTheyLeaveIsSaid) {
  const dBodyID goes = scene_.body(1, {0, 0, 0}), jumps = scene_.body(1, {3, 0, 0}),
                moves = scene_.body(1, {6, 0, 0});
  follow();
  EXPECT_TRUE(left_.empty());
  dGeomDestroy(dBodyGetFirstGeom(goes));
  dBodySetPosition(jumps, 3, 0, 5);
  dBodySetPosition(moves, 6.001, 0, 0);
  follow();
  ASSERT_EQ(left_.size(), 2U);
  EXPECT_LT(left_[0].center().norm(), 1e-9);
  EXPECT_LT((left_[1].center() - Vec3(3, 0, 0)).norm(), 1e-9);
}

// A body of several geoms is all of them, about its own centre of mass; one that changes its size is another
// shape.
TEST_F(BodiesOfCaller, AShapeIsThatOfAllItsGeoms) {
  const dBodyID body = scene_.body(1, {0, 0, 0});
  const dGeomID arm = scene_.box({0.2, 0.2, 0.2}, {0, 0, 0});
  dGeomSetBody(arm, body);
  dGeomSetOffsetPosition(arm, 0.9, 0, 0);
  follow();
  EXPECT_NEAR(gather()[0].shape->radius, Vec3(1.0, 0.1, 0.1).norm(), 1e-6);
  dGeomBoxSetLengths(arm, 0.4, 0.2, 0.2);
  follow();
  EXPECT_NEAR(gather()[0].shape->radius, Vec3(1.1, 0.1, 0.1).norm(), 1e-6);
  EXPECT_EQ(callers_.find_parts(*scene_.mirror).size(), 2U);
}

// What costs milliseconds where it is round is made once, for those to come, too.
TEST_F(BodiesOfCaller, TheSameGeomsAreMadeOnce) {
  const auto add_ball = [&](double radius, double offset) {
    const dBodyID body = scene_.body(2.0, {0, 0, 0});
    dGeomDestroy(dBodyGetFirstGeom(body));
    const dGeomID geom = dCreateSphere(scene_.space, radius);
    dGeomSetBody(geom, body);
    if (offset > 0.0) dGeomSetOffsetPosition(geom, offset, 0, 0);
    return body;
  };
  const auto solids_of = [&](dBodyID body) {
    const std::vector<CallersPart> parts = callers_.find_parts(*scene_.mirror);
    return std::ranges::find(parts, body, &CallersPart::body)->solids;
  };
  const auto shape_of = [&](dBodyID body) {
    std::vector<FullNeighbor> all = gather();
    return of(all, body).shape;
  };
  const dBodyID first = add_ball(0.1, 0.0), alike = add_ball(0.1, 0.0), aside = add_ball(0.1, 0.05),
                larger = add_ball(0.2, 0.0);
  follow();
  const auto made = solids_of(first);
  EXPECT_EQ(solids_of(alike), made);
  EXPECT_NE(solids_of(aside), made);
  EXPECT_NE(solids_of(larger), made);
  EXPECT_EQ(shape_of(first)->sphere_radius, 0.1);
  EXPECT_EQ(shape_of(alike)->sphere_radius, 0.1);
  EXPECT_FALSE(shape_of(aside)->sphere_radius);
  EXPECT_EQ(shape_of(larger)->sphere_radius, 0.2);
  for (const dBodyID body : {first, alike}) {
    dGeomDestroy(dBodyGetFirstGeom(body));
    dBodyDestroy(body);
  }
  follow();
  const dBodyID later = add_ball(0.1, 0.0);
  dMass its_own;
  dMassSetSphereTotal(&its_own, 7.0, 0.3);
  dBodySetMass(later, &its_own);
  follow();
  EXPECT_EQ(solids_of(later), made);
  EXPECT_NEAR(shape_of(later)->inertia_per_mass(0, 0), 0.4 * 0.09, 1e-12);
}

TEST_F(BodiesOfCaller, NearAreThoseWhoseBallsMeet) {
  scene_.body(1, {0, 0, 0}), scene_.body(1, {3, 0, 0});
  follow();
  for (const auto& [radius, expected] : {std::pair(0.5, 0), {0.66, 1}, {3.66, 2}}) {
    int met = 0;
    callers_.each_near({-1, 0, 0}, radius, {}, [&](const Shape&, const RigidState&) { ++met; });
    EXPECT_EQ(met, expected) << radius;
  }
}

// Parts are found where they are now, though he moved or destroyed them since the last look.
TEST_F(BodiesOfCaller, PartsAreWhereTheyAreNow) {
  const dBodyID a = scene_.body(1, {0, 0, 0}), b = scene_.body(1, {3, 0, 0});
  follow();
  dBodySetPosition(a, 7, 7, 7);
  dGeomDestroy(dBodyGetFirstGeom(b));
  const std::vector<CallersPart> parts = callers_.find_parts(*scene_.mirror);
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(parts[0].body, a);
  EXPECT_EQ(parts[0].position, Vec3(7, 7, 7));
  dBodyDestroy(b);
}

TEST_F(BodiesOfCaller, HaveTheirGeomsAndMassesAsTheyAreNow) {
  const dBodyID body = scene_.body(2.0, {1, 2, 3});
  const dGeomID geom = dBodyGetFirstGeom(body);
  follow();
  auto neighbors = gather();
  const Vec3 before = of(neighbors, body).shape->hull.vertices[0];
  dGeomSetOffsetPosition(geom, 0.5, 0, 0);
  follow();
  neighbors = gather();
  EXPECT_LT((of(neighbors, body).shape->hull.vertices[0] - before - Vec3(0.5, 0, 0)).norm(), 1e-9);
  dMass mass;
  dMassSetBoxTotal(&mass, 2.0, 1, 2, 3);
  dBodySetMass(body, &mass);
  follow();
  neighbors = gather();
  EXPECT_NEAR(of(neighbors, body).shape->inertia_per_mass(0, 0), (2 * 2 + 3 * 3) / 12.0, 1e-12);
}

}  // namespace
}  // namespace lodestone
