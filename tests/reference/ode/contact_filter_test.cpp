// The filter by itself, on solids that are known in closed form.
#include "reference/ode/contact_filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lodestone {
namespace {

// The first body fills z ≥ −depth, the second z ≤ 0 and, with a wall, x ≤ 0 too.
struct FloorAndWall {
  double depth = 1e-3;
  bool wall = false;
  double wall_depth = 5e-3;  // of the first body's face at x = −wall_depth

  std::optional<WayOut> operator()(const Vec3& place, const Vec3& direction, double longest) const {
    constexpr double kRounding = 1e-2;
    const bool in_second = place.z() <= kRounding || (wall && place.x() <= kRounding);
    const bool in_first = place.z() >= -depth - kRounding && (!wall || place.x() >= -wall_depth - kRounding);
    if (!in_second || !in_first) return {};
    const double up = direction.z() > 1e-6 ? depth / direction.z() : 100.0;
    const double aside = wall && direction.x() > 1e-6 ? wall_depth / direction.x() : 100.0;
    const bool on_floor = !wall || place.x() > kRounding;
    const double away = on_floor ? up : (place.z() > kRounding ? aside : std::max(up, aside));
    const Vec3 face = on_floor ? Vec3::UnitZ() : Vec3::UnitX();
    return WayOut{away, face, away > longest ? std::nullopt : std::optional(face)};
  }
};

TEST(ContactFilter, KeepsContactsThatAgree) {
  std::array<ContactPoint, 3> contacts{
      {{{0, 0, 0}, {0, 0, 1}, 1e-3}, {{1, 0, 0}, {0, 0, 1}, 2e-3}, {{0, 1, 0}, {0.1, 0, 0.995}, 1e-3}}};
  EXPECT_TRUE(plainly_believable(contacts, 1.0));
  const auto before = contacts;
  EXPECT_EQ(filter_contacts(contacts, 1.0, FloorAndWall{}), 3);
  for (const ContactPoint& c : before)
    EXPECT_TRUE(std::ranges::any_of(
        contacts, [&](const ContactPoint& d) { return c.point == d.point && c.normal == d.normal; }));
}

TEST(ContactFilter, TurnsAFalseContactThroughTheBodyUpright) {
  std::array<ContactPoint, 4> contacts{{{{0, 0, 0}, {0, 0, 1}, 1e-3},
                                        {{1, 0, 0}, {0, 0, 1}, 1e-3},
                                        {{0, 1, 0}, {0, 0, 1}, 1e-3},
                                        {{1, 1, 0}, {1, 0, 0}, 0.97}}};
  EXPECT_FALSE(plainly_believable(contacts, 1.0));
  ASSERT_EQ(filter_contacts(contacts, 1.0, FloorAndWall{}), 4);
  for (const ContactPoint& contact : contacts) {
    EXPECT_EQ(contact.normal, Vec3::UnitZ());
    EXPECT_NEAR(contact.depth, 1e-3, 1e-12);
  }
}

TEST(ContactFilter, FindsTheDirectionWhereEveryContactIsFalse) {
  std::array<ContactPoint, 2> contacts{{{{0, 0, 0}, {0, 1, 0}, 0.02}, {{1, 1, 0}, {1, 0, 0}, 0.3}}};
  ASSERT_EQ(filter_contacts(contacts, 1.0, FloorAndWall{}), 2);
  for (const ContactPoint& contact : contacts) EXPECT_EQ(contact.normal, Vec3::UnitZ());
}

TEST(ContactFilter, KeepsFloorAndWallOfACorner) {
  std::vector<ContactPoint> contacts;
  for (const double y : {0.0, 0.5, 1.0}) {
    contacts.push_back({{0.5, y, 0}, {0, 0, 1}, 5e-4});
    contacts.push_back({{1.0, y, 0}, {0, 0, 1}, 5e-4});
    contacts.push_back({{0, y, 0.5}, {1, 0, 0}, 5e-3});
    contacts.push_back({{0, y, 1.0}, {1, 0, 0}, 5e-3});
  }
  const FloorAndWall corner{.depth = 5e-4, .wall = true, .wall_depth = 5e-3};
  const int kept = filter_contacts(contacts, 0.3, corner);
  ASSERT_EQ(kept, 12);
  EXPECT_EQ(std::ranges::count(contacts, Vec3(1, 0, 0), &ContactPoint::normal), 6);
  EXPECT_EQ(std::ranges::count(contacts, Vec3(0, 0, 1), &ContactPoint::normal), 6);
}

// Many false directions, which all want to be looked at: once the search has measured enough it takes the
// best that it has, which is upright.
TEST(ContactFilter, EndsTheSearchOnceEnoughWasMeasured) {
  const auto filter = [](int most_measures, int& measured) {
    std::vector<ContactPoint> contacts{{{0, 0, 0}, {0, 0, 1}, 1e-3}};
    for (int i = 1; i < 40; ++i)
      contacts.push_back({{0.1 * (i % 7), 0.1 * (i / 7), 0},
                          Vec3(std::cos(i), std::sin(i), 0.3 * std::cos(3.0 * i)).normalized(),
                          0.2 + 0.01 * i});
    const int kept = filter_contacts(
        contacts, 1.0,
        [&](const Vec3& place, const Vec3& direction, double longest) {
          return ++measured, FloorAndWall{}(place, direction, longest);
        },
        most_measures);
    for (const ContactPoint& contact : std::span(contacts).first(std::size_t(kept)))
      EXPECT_GT(contact.normal.z(), 0.9);
    return kept;
  };
  int all = 0, some = 0;
  EXPECT_EQ(filter(std::numeric_limits<int>::max(), all), 40);
  EXPECT_EQ(filter(60, some), 40);
  EXPECT_GT(all, 200);
  EXPECT_LT(some, all * 2 / 3);
}

TEST(ContactReduction, TakesTheDeepestAndSpreadsTheRest) {
  std::vector<ContactPoint> contacts;
  for (int i = 0; i < 100; ++i)
    contacts.push_back({{0.01 * (i % 10), 0.01 * (i / 10), 0}, {0, 0, 1}, i == 44 ? 2e-3 : 1e-3});
  const int kept = reduce_contacts(contacts, 5, 1.0);
  ASSERT_EQ(kept, 5);
  EXPECT_EQ(contacts[0].depth, 2e-3);
  // With the deepest near the middle, the rest are the four corners.
  for (int i = 1; i < 5; ++i) EXPECT_GT((contacts[i].point - Vec3(0.045, 0.045, 0)).norm(), 0.06);
  EXPECT_EQ(reduce_contacts(std::span(contacts).first(3), 5, 1.0), 3);
}

TEST(ContactReduction, WhatLiesWithinAFaceCarriesNothingUnlessItIsDeeper) {
  const auto square = [](const Vec3& inner, double depth) {
    std::vector<ContactPoint> contacts{{inner, {0, 0, 1}, depth}};
    for (const double x : {-0.1, 0.1})
      for (const double y : {-0.1, 0.1}) contacts.push_back({{x, y, 0}, {0, 0, 1}, 1e-4});
    contacts.push_back({{0.1, 0.02, 0}, {0, 0, 1}, 1e-4});  // on an edge
    return contacts;
  };
  const auto kept = [](std::vector<ContactPoint> contacts) { return drop_inner_contacts(contacts, 0.17); };
  auto contacts = square({0.01, -0.02, 0}, 1.00001e-4);
  ASSERT_EQ(drop_inner_contacts(contacts, 0.17), 5);
  for (int i = 0; i < 5; ++i) EXPECT_GT(contacts[std::size_t(i)].point.norm(), 0.1);
  EXPECT_EQ(kept(square({0, 0, 0}, 2e-4)), 6);        // a bulge
  EXPECT_EQ(kept(square({0.09999, 0, 0}, 1e-4)), 6);  // as good as on an edge
  contacts = square({0, 0, 0}, 1e-4);
  contacts.back().normal = Vec3(0, 1, 0);
  EXPECT_EQ(kept(contacts), 6);
  EXPECT_EQ(kept({{{0, 0, 0}, {0, 0, 1}, 0},
                  {{1, 0, 0}, {0, 0, 1}, 0},
                  {{2, 0, 0}, {0, 0, 1}, 0},
                  {{1, 0, 0}, {0, 0, 1}, 0}}),
            4);
  contacts = square({0, 0, 0}, 1e-4);
  contacts.back().depth = 5e-4;  // no faces that are flush
  EXPECT_EQ(kept(contacts), 6);
  EXPECT_EQ(kept({}), 0);
}

}  // namespace
}  // namespace lodestone
