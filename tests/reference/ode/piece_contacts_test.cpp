#include "reference/ode/piece_contacts.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "reference/random.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

// A bar of 1 m, as one box, or cut in two that overlap by a fifth of their length.
struct Bars {
  std::shared_ptr<const Shape> whole = testing::box_shape({1.0, 0.2, 0.2});
  std::shared_ptr<const Shape> half = testing::box_shape({0.6, 0.2, 0.2});
  Pieces one(const RigidState& state) const { return {{{whole.get()}}, state}; }
  Pieces two(const RigidState& state) const {
    return {{{half.get(), Vec3(-0.2, 0, 0)}, {half.get(), Vec3(0.2, 0, 0)}}, state};
  }
};

std::vector<ContactPoint> contacts_of(const Pieces& a, const Pieces& b) {
  std::vector<ContactPoint> contacts;
  find_contacts_of_pieces(a, b, contacts);
  return contacts;
}

double deepest(const std::vector<ContactPoint>& contacts) {
  double depth = -1e9;
  for (const ContactPoint& contact : contacts) depth = std::max(depth, contact.depth);
  return depth;
}

TEST(PieceContacts, ABarInTwoPiecesLiesAsOneInOne) {
  const Bars bars;
  for (const double overlap : {0.001, 0.005}) {
    const RigidState low = testing::at({0, 0, 0}), high = testing::at({0.05, 0.03, 0.2 - overlap});
    const auto whole = contacts_of(bars.one(high), bars.one(low)),
               cut = contacts_of(bars.two(high), bars.two(low));
    ASSERT_FALSE(whole.empty());
    ASSERT_FALSE(cut.empty());
    EXPECT_NEAR(deepest(cut), deepest(whole), 1e-5);
    EXPECT_NEAR(deepest(whole), overlap, 2e-5);
    for (const ContactPoint& contact : cut) {
      EXPECT_LT((contact.normal - Vec3::UnitZ()).norm(), 1e-6);  // none from a face within the bar
      EXPECT_LE(std::abs(contact.point.x() - 0.05), 0.5 + 1e-6);
    }
  }
}

TEST(PieceContacts, NoneWhereTheyAreApart) {
  const Bars bars;
  EXPECT_TRUE(contacts_of(bars.two(testing::at({0, 0, 0.2001})), bars.two(testing::at({0, 0, 0}))).empty());
  EXPECT_TRUE(contacts_of({}, bars.two(testing::at({0, 0, 0}))).empty());
}

TEST(PieceContacts, AreAddedToThoseThatAreThere) {
  const Bars bars;
  std::vector<ContactPoint> contacts(3);
  contacts[1].depth = 7.0;
  find_contacts_of_pieces(bars.two(testing::at({0, 0, 0.199})), bars.two(testing::at({0, 0, 0})), contacts);
  EXPECT_GT(contacts.size(), 3U);
  EXPECT_EQ(contacts[1].depth, 7.0);
}

// Whichever is named first: the same depths, normals the other way round.
TEST(PieceContacts, TurnRoundWithTheBodies) {
  const Bars bars;
  RandomStream random(5, 0, 0);
  int touching = 0;
  for (int i = 0; i < 60; ++i) {
    const Vec3 apart = random.uniform(0.1, 0.5) * random.direction();
    const Pieces a = bars.two(testing::at({0, 0, 0}, {0, 0, 0}, {0, 0, 0}, random.orientation())),
                 b = bars.two(testing::at(apart, {0, 0, 0}, {0, 0, 0}, random.orientation()));
    const auto there = contacts_of(a, b), back = contacts_of(b, a);
    EXPECT_EQ(there.empty(), back.empty());
    if (there.empty() || back.empty()) continue;
    ++touching;
    EXPECT_NEAR(deepest(there), deepest(back), 1e-6);
  }
  EXPECT_GT(touching, 20);
}

// The whole scene moved and turned: contacts go along.
TEST(PieceContacts, GoAlongWithTheWorld) {
  const Bars bars;
  RandomStream random(6, 0, 0);
  const Quat turn = random.orientation();
  const Vec3 away(3, -2, 1);
  const RigidState low = testing::at({0, 0, 0}), high = testing::at({0.1, 0.02, 0.196});
  const auto moved = [&](const RigidState& state) {
    return testing::at(turn * state.position + away, {0, 0, 0}, {0, 0, 0}, turn * state.orientation);
  };
  const auto here = contacts_of(bars.two(high), bars.two(low)),
             there = contacts_of(bars.two(moved(high)), bars.two(moved(low)));
  ASSERT_FALSE(here.empty());
  EXPECT_NEAR(deepest(here), deepest(there), 1e-6);
  for (const ContactPoint& contact : there) EXPECT_LT((contact.normal - turn * Vec3::UnitZ()).norm(), 1e-5);
}

}  // namespace
}  // namespace lodestone
