#include "reference/hull/hull_manifold.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "reference/random.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

std::vector<ContactPoint> find_contacts(const Shape& first, const RigidState& a, const Shape& second,
                                        const RigidState& b) {
  std::vector<ContactPoint> contacts;
  if (const auto overlap = find_hull_overlap(first, a, second, b))
    find_hull_manifold(first, a, second, b, *overlap, contacts);
  return contacts;
}

bool holds(const std::vector<ContactPoint>& contacts, const Vec3& point) {
  return std::ranges::any_of(contacts,
                             [&](const ContactPoint& c) { return (c.point - point).norm() < 1e-9; });
}

TEST(HullManifold, OfABoxOnALargerOneIsItsFourCorners) {
  const auto small = box_shape({0.2, 0.3, 0.4}), large = box_shape({2, 2, 2});
  const auto contacts = find_contacts(*small, at({0.1, 0.2, 1.199}), *large, at({0, 0, 0}));
  for (const double x : {0.0, 0.2})
    for (const double y : {0.05, 0.35}) EXPECT_TRUE(holds(contacts, {x, y, 0.9995}));
  for (const ContactPoint& contact : contacts) {
    EXPECT_NEAR(contact.normal.z(), 1.0, 1e-12);
    EXPECT_NEAR(contact.depth, 1e-3, 1e-12);
  }
}

// Two squares, one turned by an eighth: the contacts are the octagon's corners, where edges cross.
TEST(HullManifold, OfCrossedFacesHasTheCrossingsOfTheirEdges) {
  const auto box = box_shape({1, 1, 1});
  const Quat turned(Eigen::AngleAxisd(0.25 * std::numbers::pi, Vec3::UnitZ()));
  const auto contacts =
      find_contacts(*box, at({0, 0, 0.99}, Vec3::Zero(), Vec3::Zero(), turned), *box, at(Vec3::Zero()));
  const double along = std::sqrt(0.5) - 0.5;  // where |x| + |y| = √½ meets x = ½
  for (const double side : {-1.0, 1.0})
    for (const double other : {-along, along}) {
      EXPECT_TRUE(holds(contacts, {0.5 * side, other, 0.495}));
      EXPECT_TRUE(holds(contacts, {other, 0.5 * side, 0.495}));
    }
}

TEST(HullManifold, OfCrossedEdgesIsOnePoint) {
  const auto box = box_shape({1, 1, 1});
  const Quat on_edge_x(Eigen::AngleAxisd(0.25 * std::numbers::pi, Vec3::UnitX())),
      on_edge_y(Eigen::AngleAxisd(0.25 * std::numbers::pi, Vec3::UnitY()));
  const auto contacts =
      find_contacts(*box, at({0, 0, 2 * std::sqrt(0.5) - 0.01}, Vec3::Zero(), Vec3::Zero(), on_edge_x), *box,
                    at(Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), on_edge_y));
  ASSERT_FALSE(contacts.empty());
  for (const ContactPoint& contact : contacts) {
    EXPECT_LT(contact.point.head<2>().norm(), 1e-9);
    EXPECT_NEAR(contact.depth, 0.01, 1e-9);
    EXPECT_NEAR(contact.normal.z(), 1.0, 1e-9);
  }
}

// What came out behind a thin plate is as deep as the way back through it.
TEST(HullManifold, OfACornerThatPiercesAPlateIsThatCorner) {
  const auto cube = box_shape({0.2, 0.2, 0.2}), plate = box_shape({2, 2, 0.02});
  const Quat on_corner = Quat::FromTwoVectors(Vec3(1, 1, 1), -Vec3::UnitZ());
  const RigidState above = at({0.3, 0.4, 0.1 * std::sqrt(3.0) - 0.05}, Vec3::Zero(), Vec3::Zero(), on_corner),
                   stands = at({0, 0, 0});
  const auto contacts = find_contacts(*cube, above, *plate, stands);
  EXPECT_TRUE(holds(contacts, {0.3, 0.4, -0.02}));
  const auto back = find_contacts(*plate, stands, *cube, above);
  EXPECT_TRUE(holds(back, {0.3, 0.4, -0.02}));
  for (const auto& [found, up] : {std::pair(contacts, 1.0), std::pair(back, -1.0)}) {
    ASSERT_FALSE(found.empty());
    EXPECT_NEAR(std::ranges::max(found, {}, &ContactPoint::depth).depth, 0.06, 1e-9);
    for (const ContactPoint& contact : found) EXPECT_NEAR(contact.normal.z(), up, 1e-9);
  }
}

// Seen along the way out it passes beside the plate, though it is lower than its top.
TEST(HullManifold, OfACornerBesideAPlateIsNone) {
  const auto cube = box_shape({0.2, 0.2, 0.2}), plate = box_shape({2, 2, 0.02});
  const Quat on_edge(Eigen::AngleAxisd(0.3, Vec3::UnitY()));
  const auto contacts =
      find_contacts(*cube, at({1.03, 0, 0.1}, Vec3::Zero(), Vec3::Zero(), on_edge), *plate, at({0, 0, 0}));
  ASSERT_FALSE(contacts.empty());
  for (const ContactPoint& contact : contacts) EXPECT_LT(contact.point.x(), 1.01);
}

TEST(HullManifold, RolesSwappedMirrorTheContacts) {
  const auto box = box_shape({0.2, 0.3, 0.4});
  for (std::uint32_t pose = 0; pose < 200; ++pose) {
    RandomStream random(5, pose, 0);
    const RigidState a = at(0.2 * random.direction(), Vec3::Zero(), Vec3::Zero(), random.orientation()),
                     b = at(Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), random.orientation());
    auto there = find_contacts(*box, a, *box, b), back = find_contacts(*box, b, *box, a);
    ASSERT_EQ(there.size(), back.size());
    if (there.empty()) continue;
    EXPECT_NEAR(there[0].normal.dot(back[0].normal), -1.0, 1e-9);
    for (const ContactPoint& contact : there)
      EXPECT_TRUE(std::ranges::any_of(
          back, [&](const ContactPoint& c) { return (c.point - contact.point).norm() < 1e-6; }));
  }
}

// Moved along the normal by the greatest depth the two are clear, by less they are not; contacts lie in both.
TEST(HullManifold, DepthsAreThoseOfTheWayOut) {
  const auto bunny = std::make_shared<const Shape>(make_bunny_shape(0.2, 500));
  int met = 0;
  for (std::uint32_t pose = 0; pose < 300; ++pose) {
    RandomStream random(6, pose, 0);
    const RigidState b = at(Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), random.orientation());
    RigidState a =
        at(random.uniform(0.1, 0.2) * random.direction(), Vec3::Zero(), Vec3::Zero(), random.orientation());
    const auto overlap = find_hull_overlap(*bunny, a, *bunny, b);
    if (!overlap) continue;
    ++met;
    std::vector<ContactPoint> contacts;
    find_hull_manifold(*bunny, a, *bunny, b, *overlap, contacts);
    ASSERT_FALSE(contacts.empty());
    EXPECT_NEAR(std::ranges::max(contacts, {}, &ContactPoint::depth).depth, overlap->depth,
                1e-6 * bunny->size);
    a.position += (overlap->depth - 1e-9) * overlap->direction;
    EXPECT_TRUE(find_hull_overlap(*bunny, a, *bunny, b));
    a.position += 2e-9 * overlap->direction;
    EXPECT_FALSE(find_hull_overlap(*bunny, a, *bunny, b));
  }
  EXPECT_GT(met, 50);
}

}  // namespace
}  // namespace lodestone
