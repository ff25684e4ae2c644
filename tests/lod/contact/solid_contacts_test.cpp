#include "lod/contact/solid_contacts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "lod/contact/faces_below.h"
#include "lod/contact/hull_contacts.h"

namespace lodestone {
namespace {

constexpr double kSolidStep = 1.0 / 60, kSide = 0.2;

// A table of 2 × 2 × 1 m whose upper side is at z = 0, and a cube.
class SolidContacts : public ::testing::Test {
 protected:
  SolidContacts() { ground_.add_box({2, 2, 1}, {0, 0, -0.5}, Quat::Identity(), 3); }

  StatisticalBody body_at(const Vec3& position, const Vec3& velocity = Vec3::Zero()) const {
    StatisticalBody body;
    body.position = position;
    body.velocity = velocity;
    return body;
  }
  void find(const StatisticalBody& body) {
    found_.clear(), planes_.clear();
    find_solid_contacts(body, kind_, 5, ground_, 0.0, kSolidStep, found_, planes_);
  }
  void find_of_sphere(StatisticalBody body, double radius) {
    body.sphere_radius = float(radius);
    found_.clear(), planes_.clear();
    find_sphere_contacts(body, kind_, 5, ground_, 0.0, kSolidStep, found_, planes_);
  }

  Ground ground_;
  BodyKind kind_ =
      make_body_kind(std::make_shared<const Shape>(make_shape("cube", make_box({kSide, kSide, kSide}))));
  std::vector<SolidContact> found_;
  std::vector<HalfSpace> planes_;
};

TEST_F(SolidContacts, OverTheInsideOfAFaceItIsAPlane) {
  find(body_at({0.3, 0.2, 0.5 * kSide}));
  EXPECT_TRUE(found_.empty());
  ASSERT_EQ(planes_.size(), 1U);
  EXPECT_LT((planes_[0].normal - Vec3::UnitZ()).norm(), 1e-9);
  EXPECT_NEAR(planes_[0].offset, 0.0, 1e-9);
  EXPECT_EQ(planes_[0].material, 3);
}

TEST_F(SolidContacts, AtAnEdgeItIsAContactOfHulls) {
  find(body_at({1.02, 0.2, 0.5 * kSide}));  // its middle beyond the table's side
  EXPECT_TRUE(planes_.empty());
  ASSERT_EQ(found_.size(), 1U);
  EXPECT_EQ(found_[0].slot, 5);
  EXPECT_EQ(found_[0].material, 3);
  EXPECT_NEAR(found_[0].contact.normal.z(), 1.0, 1e-6);
  EXPECT_EQ(found_[0].contact.manifold.count, 4);
  for (int i = 0; i < 4; ++i)
    EXPECT_LT(found_[0].contact.manifold.points[std::size_t(i)].point.x(), 1.0 + 1e-5);  // on the table
}

TEST_F(SolidContacts, WhatDoesNotCloseWithinTheStepIsNone) {
  const Vec3 above{1.02, 0.2, 0.5 * kSide + 0.05};
  find(body_at(above));
  EXPECT_TRUE(found_.empty());
  find(body_at(above, {0, 0, -4}));  // .067 m in a step
  EXPECT_EQ(found_.size(), 1U);
  find(body_at(above, {0, 0, 4}));
  EXPECT_TRUE(found_.empty());
  find(body_at({8, 0, 0.1}));
  EXPECT_TRUE(found_.empty() && planes_.empty());
}

TEST_F(SolidContacts, APartThatMovesIsNoPlane) {
  Ground moving;
  const GroundId id = moving.add_box({2, 2, 1}, Vec3::Zero(), Quat::Identity(), 0);
  moving.move_part(id, {.position = {0, 0, -0.5}, .velocity = {0.5, 0, 0}});
  find_solid_contacts(body_at({0.3, 0.2, 0.5 * kSide}), kind_, 5, moving, 0.0, kSolidStep, found_, planes_);
  EXPECT_TRUE(planes_.empty());
  ASSERT_EQ(found_.size(), 1U);
  EXPECT_EQ(found_[0].part->velocity_at(Vec3::Zero()), Vec3(0.5, 0, 0));
}

TEST_F(SolidContacts, AFaceBelowIsFoundAwayFromTheEdgesOnly) {
  std::vector<const GroundPart*> parts;
  ground_.find_parts(Vec3::Zero(), 10.0, parts);
  ASSERT_EQ(parts.size(), 1U);
  std::vector<PlacedSolid> solids;
  find_solids(*parts[0], Vec3::Zero(), 10.0, 0.0, solids);
  ASSERT_EQ(solids.size(), 1U);
  EXPECT_TRUE(find_face_below(solids[0], {0.3, 0.2, 0.1}, 0.2));
  EXPECT_FALSE(find_face_below(solids[0], {0.9, 0.2, 0.1}, 0.2));   // .1 m from the side
  EXPECT_FALSE(find_face_below(solids[0], {1.1, 0.2, 0.1}, 0.2));   // over an edge
  EXPECT_FALSE(find_face_below(solids[0], {0.3, 0.2, -0.1}, 0.2));  // inside
}

TEST_F(SolidContacts, ASphereMeetsWhatIsNearestToIt) {
  find_of_sphere(body_at({0.3, 0.2, 0.1}), 0.1);
  EXPECT_TRUE(found_.empty());
  ASSERT_EQ(planes_.size(), 1U);
  EXPECT_NEAR(planes_[0].height_of({0.3, 0.2, 0.1}), 0.1, 1e-9);
  find_of_sphere(body_at({1.06, 0.2, 0.08}), 0.1);  // .1 m from the edge at (1, .2, 0)
  ASSERT_EQ(planes_.size(), 1U);
  EXPECT_LT((planes_[0].normal - Vec3(0.6, 0, 0.8)).norm(), 1e-6);
  EXPECT_NEAR(planes_[0].height_of({1.06, 0.2, 0.08}), 0.1, 1e-6);
}

TEST_F(SolidContacts, OverAFaceIsNoEdge) {
  std::vector<GroundNear> near;
  find_ground_near(ground_, {0.3, 0.2, 0.1}, 0.2, 0.0, near);
  find_ground_near(ground_, {1.06, 0.2, 0.08}, 0.2, 0.0, near);
  ASSERT_EQ(near.size(), 2U);
  EXPECT_FALSE(near[0].at_edge);
  EXPECT_TRUE(near[1].at_edge);
}

// A corner that hangs over the edge of the table and below its face does not lie on this: the edge holds the
// hull.
TEST_F(SolidContacts, AHullThatHangsOverAnEdgeLiesOnTheEdge) {
  constexpr double kTilt = 0.349;  // rad
  const Shape cube = make_shape("cube", make_box({kSide, kSide, kSide}));
  const PairBody hull{&cube, {0.98, 0.2, 0.112}, Quat(Eigen::AngleAxisd(kTilt, Vec3::UnitY()))};
  std::vector<GroundNear> bare, near;
  find_ground_near(ground_, hull.position, 0.2, 0.0, bare);
  find_ground_near(ground_, hull.position, 0.2, 0.0, near, &hull);
  const auto gap = [&](const GroundNear& of) {
    std::int32_t hint = 0;
    return find_lowest_point(cube, hull.orientation, of.normal, of.height, hint).gap;
  };
  ASSERT_EQ(bare.size(), 1U);
  EXPECT_LT(gap(bare[0]), -0.01);
  ASSERT_EQ(near.size(), 1U);
  EXPECT_LT((near[0].normal - Vec3(std::sin(kTilt), 0, std::cos(kTilt))).norm(), 1e-3);
  EXPECT_NEAR(gap(near[0]), -0.002, 1e-3);
  EXPECT_TRUE(near[0].at_edge);
}

// Where a wall stands on the table, one plane would let it sink into the other.
TEST_F(SolidContacts, InACornerASphereHasAContactOfEach) {
  ground_.add_box({1, 2, 1}, {-0.5, 0, 0.5}, Quat::Identity(), 0);
  find_of_sphere(body_at({0.1, 0, 0.1}), 0.1);
  EXPECT_TRUE(planes_.empty());
  ASSERT_EQ(found_.size(), 2U);
  EXPECT_LT((found_[0].contact.normal - Vec3::UnitZ()).norm(), 1e-9);
  EXPECT_LT((found_[1].contact.normal - Vec3::UnitX()).norm(), 1e-9);
  for (const SolidContact& contact : found_) EXPECT_NEAR(contact.contact.gap, 0.0, 1e-7);
}

// A floor of triangles, level up to x = 0, from there falling or rising by a tenth.
Mesh make_bent_floor(double slope) {
  Mesh mesh;
  constexpr int kCells = 12;
  for (int y = 0; y <= kCells; ++y)
    for (int x = 0; x <= kCells; ++x)
      mesh.vertices.emplace_back(0.25 * (x - 6), 0.25 * (y - 6), std::max(0.0, slope * 0.25 * (x - 6)));
  if (slope < 0.0)
    for (Vec3& v : mesh.vertices) v.z() = std::min(0.0, slope * v.x());
  for (int y = 0; y < kCells; ++y)
    for (int x = 0; x < kCells; ++x) {
      const int a = y * (kCells + 1) + x, b = a + 1, c = a + kCells + 1, d = c + 1;
      mesh.faces.push_back({a, b, d}), mesh.faces.push_back({a, d, c});
    }
  return mesh;
}

// Whatever seams it has, a floor is one plane, a hollow two; where it falls away or ends it is none.
TEST(SurfaceContacts, AFloorOfTrianglesIsAPlaneToBodies) {
  const BodyKind kind =
      make_body_kind(std::make_shared<const Shape>(make_shape("cube", make_box({kSide, kSide, kSide}))));
  const auto planes_at = [&](double slope, const Vec3& position, std::size_t& contacts) {
    Ground ground;
    ground.add_mesh(make_bent_floor(slope), 3);
    StatisticalBody body;
    body.position = position;
    std::vector<SolidContact> found;
    std::vector<HalfSpace> planes;
    find_solid_contacts(body, kind, 5, ground, 0.0, kSolidStep, found, planes);
    contacts = found.size();
    return planes;
  };
  std::size_t contacts = 0;
  for (const Vec3& place : {Vec3(-0.6, 0.1, 0.1), Vec3(-0.5, 0.25, 0.1), Vec3(-0.75, 0.0, 0.12)}) {
    const auto planes = planes_at(0.1, place, contacts);
    ASSERT_EQ(planes.size(), 1u);
    EXPECT_EQ(contacts, 0u);
    EXPECT_NEAR(planes[0].height_of(place), place.z(), 1e-9);
    EXPECT_EQ(planes[0].material, 3u);
  }
  EXPECT_EQ(planes_at(0.1, {-0.02, 0.1, 0.1}, contacts).size(), 2u);
  EXPECT_EQ(contacts, 0u);
  EXPECT_TRUE(planes_at(-0.1, {-0.02, 0.1, 0.1}, contacts).empty());
  EXPECT_GT(contacts, 0u);
  EXPECT_TRUE(planes_at(0.1, {-1.45, 0.1, 0.1}, contacts).empty()) << "at its border";
  EXPECT_TRUE(planes_at(0.1, {-0.6, 0.1, 0.8}, contacts).empty()) << "out of reach";
  EXPECT_EQ(contacts, 0u);
}

// So gentle that no edge stands out: along each triangle's normal the cube is lowest over another one. It
// fell through.
TEST(SurfaceContacts, AGentleHillTopHoldsWhatStraddlesIt) {
  const BodyKind kind =
      make_body_kind(std::make_shared<const Shape>(make_shape("cube", make_box({kSide, kSide, kSide}))));
  Mesh hill;
  hill.vertices = {{0, 0, 0}, {1, 0, -0.03}, {0, 1, -0.03}, {-1, 0, -0.03}, {0, -1, -0.03}};
  for (int i = 0; i < 4; ++i) hill.faces.push_back({0, 1 + i, 1 + (i + 1) % 4});
  Ground ground;
  ground.add_mesh(hill, 0);
  for (const double over : {0.0005, -0.0005}) {
    StatisticalBody body;
    body.position = {0, 0, 0.5 * kSide + over};
    std::vector<SolidContact> found;
    std::vector<HalfSpace> planes;
    find_solid_contacts(body, kind, 5, ground, 0.0, kSolidStep, found, planes);
    EXPECT_TRUE(planes.empty());
    ASSERT_FALSE(found.empty()) << over;
    EXPECT_GT(found[0].contact.normal.z(), 0.99);
    EXPECT_NEAR(found[0].contact.gap, over, 1e-3);
  }
}

// The mean of gentle slopes turns by degrees; over a border, and where the ground turns sharply, there is
// none.
TEST(PlanesBelow, OfGentleGroundAreOneThatTurnsByDegrees) {
  const BodyKind kind =
      make_body_kind(std::make_shared<const Shape>(make_shape("cube", make_box({kSide, kSide, kSide}))));
  const auto planes_at = [&](double slope, double x, bool& all) {
    Ground ground;
    ground.add_mesh(make_bent_floor(slope), 3);
    StatisticalBody body;
    body.position = {x, 0.1, 0.5 * kSide + std::min(0.0, slope * std::max(0.0, x))};
    std::vector<HalfSpace> planes;
    all = find_planes_below(body, kind, ground, 0.0, kSolidStep, planes);
    return planes;
  };
  bool all = false;
  double last = 0.0, last_offset = 0.0;
  for (double x = -0.4; x < 0.4; x += 0.01) {
    const auto planes = planes_at(-0.1, x, all);
    ASSERT_TRUE(all) << x;
    ASSERT_EQ(planes.size(), 1U) << x;
    EXPECT_EQ(planes[0].material, 3U);
    EXPECT_GE(planes[0].normal.x(), last - 1e-3) << x;
    EXPECT_LT(planes[0].normal.x(), last + 0.015) << x;
    EXPECT_NEAR(planes[0].offset, last_offset, 1e-3) << x;
    last = planes[0].normal.x(), last_offset = planes[0].offset;
  }
  EXPECT_NEAR(last, 0.1 / std::hypot(1.0, 0.1), 1e-6);
  EXPECT_TRUE(planes_at(-0.6, 0.0, all).empty());
  EXPECT_FALSE(all) << "it turns by 31 deg";
  EXPECT_TRUE(planes_at(-0.1, -1.55, all).empty());
  EXPECT_FALSE(all) << "beyond its border";
}

// Seen from a belt or a lift, its faces are planes as those of ground that stands still.
TEST(FacesGoingAlong, AreThoseOfGroundThatGoesOnAsOne) {
  const BodyKind kind =
      make_body_kind(std::make_shared<const Shape>(make_shape("cube", make_box({kSide, kSide, kSide}))));
  const Vec3 velocity(0.5, 0, 0.25);
  const auto faces_at = [&](const Vec3& position, const GroundPose& pose, bool floor) {
    Ground ground;
    ground.add_part(ground.part(ground.add_box({2, 2, 1}, {9, 9, 9}, Quat::Identity(), 3)).shape, pose, 3);
    if (floor) ground.add_plane({Vec3::UnitZ(), -0.05, 0});
    StatisticalBody body;
    body.position = position;
    std::vector<HalfSpace> faces;
    const bool all = find_faces_going_along(body, kind, ground, velocity, kSolidStep, faces);
    EXPECT_EQ(faces.empty(), !all);
    return faces;
  };
  const GroundPose going{.position = {0, 0, -0.5},
                         .orientation = Quat::Identity(),
                         .velocity = velocity,
                         .goes_on_s = kSolidStep};
  const Vec3 within(0.3, 0.2, 0.5 * kSide), at_edge(0.95, 0.2, 0.5 * kSide);
  const auto faces = faces_at(within, going, false);
  ASSERT_EQ(faces.size(), 1U);
  EXPECT_LT((faces[0].normal - Vec3::UnitZ()).norm(), 1e-9);
  EXPECT_NEAR(faces[0].offset, 0.0, 1e-9);
  EXPECT_TRUE(faces_at(at_edge, going, false).empty());
  EXPECT_TRUE(faces_at(within, going, true).empty()) << "the floor stands still";
  GroundPose other = going;
  other.velocity.x() += 0.1;
  EXPECT_TRUE(faces_at(within, other, false).empty());
  other = going, other.angular_velocity.z() = 0.1;
  EXPECT_TRUE(faces_at(within, other, false).empty());
  other = going, other.goes_on_s = 0.5 * kSolidStep;
  EXPECT_TRUE(faces_at(within, other, false).empty());
}

TEST(HeldSeveralWays, IsACornerButNotAnEvenFloor) {
  const std::vector<HalfSpace> floor{{.normal = Vec3::UnitZ()}},
      corner{{.normal = Vec3::UnitZ()}, {.normal = Vec3::UnitX()}};
  EXPECT_FALSE(is_held_several_ways({}, floor, {0.1, 0, 0.1}, 0.2));
  EXPECT_TRUE(is_held_several_ways({}, corner, {0.1, 0, 0.1}, 0.2));
  EXPECT_FALSE(is_held_several_ways({}, corner, {0.3, 0, 0.1}, 0.2));  // the wall is out of reach
  const std::vector<GroundNear> same{{.normal = Vec3::UnitZ(), .height = 0.1}},
      other{{.normal = Vec3::UnitY(), .height = 0.1}};
  EXPECT_FALSE(is_held_several_ways(same, floor, {0.1, 0, 0.1}, 0.2));
  EXPECT_TRUE(is_held_several_ways(other, floor, {0.1, 0, 0.1}, 0.2));
}

TEST(JoinedPlanes, AreThoseOfTheGroundAndTheFaces) {
  const std::vector<HalfSpace> planes{{.offset = 1.0}}, faces{{.offset = 2.0}, {.offset = 3.0}};
  EXPECT_EQ(join_planes(planes, {}).data(), planes.data());
  const auto joined = join_planes(planes, faces);
  ASSERT_EQ(joined.size(), 3U);
  EXPECT_EQ(joined[0].offset, 1.0);
  EXPECT_EQ(joined[2].offset, 3.0);
}

}  // namespace
}  // namespace lodestone
