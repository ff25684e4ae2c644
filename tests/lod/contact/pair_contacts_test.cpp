#include "lod/contact/pair_contacts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "reference/random.h"
#include "tests/prism.h"

namespace lodestone {
namespace {

constexpr double kMargin = 0.003;

PairBody at(const Shape& shape, const Vec3& position, const Quat& orientation = Quat::Identity()) {
  return {&shape, position, orientation};
}

HullContactSearch search_afresh(const PairBody& first, const PairBody& second) {
  HullGap nowhere{.normal = Vec3::Zero()};
  std::vector<KnownGap> nothing;
  HullContactSearch search;
  find_pair_contacts(first, second, nowhere, nothing, kMargin, search);
  return search;
}

class LInL : public ::testing::Test {
 protected:
  // Legs .3 and .2 m, bars .08 m wide, .1 m thick: the same way up, one's corner reaches into the other's
  // notch.
  Shape l_ = make_shape("l", make_l(0.3, 0.2, 0.08, 0.1));
  HullContactSearch search(const Vec3& shift) { return search_afresh(at(l_, shift), at(l_, Vec3::Zero())); }
};

TEST_F(LInL, BodiesClearOfEachOtherDoNotTouchThoughTheirHullsOverlap) {
  const HullContactSearch clear = search({0.1, 0.1, 0.0});
  EXPECT_TRUE(clear.contacts.empty());
  EXPECT_GT(clear.gap, kMargin);
  EXPECT_LE(clear.gap, 0.02 + 1e-9);  // never more than the true distance
  EXPECT_TRUE(find_hull_contact(at(l_, {0.1, 0.1, 0.0}), at(l_, Vec3::Zero()), kMargin).has_value());
}

TEST_F(LInL, TheyTouchWhereTheirLegsDo) {
  const HullContactSearch touching = search({0.1, 0.078, 0.0});  // 2 mm into the long leg
  ASSERT_EQ(touching.contacts.size(), 1U);
  const PairContact& contact = touching.contacts[0];
  EXPECT_NEAR(contact.gap, -0.002, 1e-6);
  EXPECT_NEAR(contact.normal.y(), 1.0, 1e-6);
  ASSERT_EQ(contact.manifold.count, 4);
  double least = 1.0, greatest = -1.0;  // along the long leg
  for (const ManifoldPoint& p : contact.manifold.points)
    least = std::min(least, p.point.x()), greatest = std::max(greatest, p.point.x());
  EXPECT_NEAR(greatest - least, 0.2, 1e-6);
}

TEST_F(LInL, BothBodiesMeetAlikeWhicheverIsFirst) {
  const Quat turned(Eigen::AngleAxisd(0.3, Vec3(1, 2, 3).normalized()));
  const PairBody a = at(l_, {0.12, 0.05, 0.04}, turned), b = at(l_, Vec3::Zero());
  const auto there = search_afresh(a, b).contacts, back = search_afresh(b, a).contacts;
  ASSERT_FALSE(there.empty());
  ASSERT_EQ(there.size(), back.size());
}

// A crate that overhangs a step of a wide flight of stairs by a corner: the step's other side, .2 m below, is
// within a hundredth of its length.
// A box goes over the rim of a leg, a hair below its top face: whose points are those of that face, on the
// box.
TEST_F(LInL, APieceThatIsPassedOverIsMetWhereItIs) {
  const Shape box = make_shape("box", make_box({0.06, 0.06, 0.06}));
  Vec3 low = Vec3::Constant(1e9), high = -low;
  const Shape& leg = l_.pieces[0];
  for (const Vec3& v : leg.hull.vertices) {
    low = low.cwiseMin(v + leg.center_of_mass_in_mesh);
    high = high.cwiseMax(v + leg.center_of_mass_in_mesh);
  }
  int passed = 0;  // points on the face
  for (const int axis : {0, 1})
    for (const double side : {-1.0, 1.0}) {
      Vec3 position = 0.5 * (low + high), way = Vec3::Zero();
      position.z() = high.z() + 0.03 - 1e-4;
      position[axis] = side < 0.0 ? low[axis] - 0.03 + 5e-5 : high[axis] + 0.03 - 5e-5;
      way[axis] = -0.02 * side;
      HullGap nowhere{.normal = Vec3::Zero()};
      std::vector<KnownGap> nothing;
      HullContactSearch search;
      search.way = PairWay{.first = way, .hair = 3e-4};
      find_pair_contacts(at(box, position), at(l_, Vec3::Zero()), nowhere, nothing, kMargin, search);
      for (const PairContact& contact : search.contacts)
        for (int i = 0; i < contact.manifold.count; ++i) {
          const Vec3& point = contact.manifold.points[std::size_t(i)].point;
          EXPECT_LT((point - position).cwiseAbs().maxCoeff(), 0.0305) << axis << ' ' << side;
          passed += contact.normal.z() > 0.99;
        }
    }
  EXPECT_GT(passed, 0);
}

TEST(PairContacts, AGreatSlabIsTouchedOnOneSide) {
  const Shape crate = make_shape("crate", make_box({0.2, 0.3, 0.4})),
              step = make_shape("step", make_box({0.35, 80.0, 0.2}));
  const PairBody lower{&step};
  for (const double gap : {-1e-3, 1e-3}) {
    const PairBody upper{
        &crate, Vec3(-0.12, 17.0, 0.1 + 0.1 + gap),
        Quat(Eigen::AngleAxisd(0.3, Vec3::UnitZ())) * Quat(Eigen::AngleAxisd(0.5 * EIGEN_PI, Vec3::UnitY()))};
    const auto contact = find_hull_contact(upper, lower, 0.01, 0.0, Vec3::UnitZ());
    ASSERT_TRUE(contact);
    EXPECT_NEAR(contact->normal.z(), 1.0, 1e-9);
    EXPECT_GE(contact->manifold.count, 3);
    for (int i = 0; i < contact->manifold.count; ++i) {
      EXPECT_NEAR(contact->manifold.points[std::size_t(i)].gap, gap, 1e-9);
      EXPECT_NEAR(contact->manifold.points[std::size_t(i)].point.z(), 0.1 + 0.5 * gap, 1e-9);
    }
  }
}

// What was found once bounds what is there later, however they have moved and turned, up to a full turn; and
// a look along the axis says what is left along it.
// Of a plate that comes down on an edge all four corners, those in the air, too, with their own gaps: but
// only where it is about to lie.
TEST(PairContacts, APlateThatIsAboutToLieIsTouchedByItsWholeFace) {
  const Shape plate = make_shape("plate", make_box({0.3, 0.3, 0.05}));
  const auto tilted_by = [&](double angle) {
    const Quat tilt(Eigen::AngleAxisd(angle, Vec3::UnitY()));
    const double half = 0.15 * std::sin(angle) + 0.025 * std::cos(angle);
    const auto contacts =
        search_afresh(at(plate, {0.01, 0.02, 0.025 + half}, tilt), at(plate, Vec3::Zero())).contacts;
    return contacts.empty() ? Manifold{} : contacts[0].manifold;
  };
  const Manifold lying = tilted_by(0.015), leaning = tilted_by(0.2);
  ASSERT_EQ(lying.count, 4);
  EXPECT_EQ(leaning.count, 2);
  int in_the_air = 0;
  for (const ManifoldPoint& p : lying.points) {
    EXPECT_GE(p.gap, -1e-6);
    in_the_air += p.gap > 0.003;
  }
  EXPECT_EQ(in_the_air, 2);
}

// All within a hundredth of its size spans three of its edges; in the outermost alone it would stand on a
// facet that it does not have, the middle one a millimetre inside the slab.
TEST(PairContacts, ABarrelIsMetInTheEdgeThatItRollsOn) {
  constexpr int kSides = 48;
  constexpr double kRadius = 0.12, kGap = 0.001;
  const auto barrel = testing::make_prism(kSides, kRadius, 0.3);
  const Shape slab = make_shape("slab", make_box({4, 4, 0.2}));
  const auto on_edge = [&](double past) {  // rad, from where an edge is lowest
    const Quat lying(Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitX()) *
                     Eigen::AngleAxisd(past, Vec3::UnitZ()));
    return at(*barrel, {0, 0, 0.1 + kRadius + kGap}, lying);
  };
  for (const double past : {-0.02, -1e-4, 1e-4, 0.02}) {
    const HullContactSearch search = search_afresh(on_edge(past), at(slab, Vec3::Zero()));
    ASSERT_EQ(search.contacts.size(), 1U);
    const PairContact& contact = search.contacts[0];
    int of_edge = 0;
    for (int i = 0; i < contact.manifold.count; ++i)
      of_edge += contact.manifold.points[std::size_t(i)].gap < contact.gap + 1e-6;
    EXPECT_EQ(of_edge, 2) << past;
  }
}

TEST(PairContacts, AGapThatWasFoundIsNeverThoughtWiderThanItIs) {
  const Shape crate = make_shape("crate", make_box({0.2, 0.3, 0.4}));
  RandomStream random(47, 0, 0);
  int told = 0;
  for (int i = 0; i < 2000; ++i) {
    const PairBody first = at(crate, random.uniform(0.3, 1.5) * random.direction(), random.orientation()),
                   second = at(crate, Vec3::Zero(), random.orientation());
    HullGap gap =
        find_hull_gap({crate, first.position, first.orientation},
                      {crate, second.position, second.orientation}, {.normal = Vec3::Zero()}, 1e300);
    const PairPose then = pose_of(first, second);
    const auto move = [&](const PairBody& body) {
      const double much = std::pow(10.0, random.uniform(-3.0, 0.5));
      return at(crate, body.position + 0.1 * much * random.direction(),
                rotation_from_vector(much * random.direction()) * body.orientation);
    };
    const PairBody one = move(first), other = move(second);
    const PlacedHull placed_one(crate, one.position, one.orientation),
        placed_other(crate, other.position, other.orientation);
    const GapLeft left = find_gap_left(gap, then, one, other);
    const double along = measure_hull_gap(placed_one, placed_other, gap.normal).gap,
                 apart = find_hull_gap(placed_one, placed_other, {.normal = Vec3::Zero()}, 1e300).gap;
    EXPECT_LE(left.along, along + 1e-6) << i;
    EXPECT_LE(left.anyhow, std::max(0.0, apart) + 1e-6) << i;
    EXPECT_NEAR(look_along(gap, one, other), along, 1e-12);
    EXPECT_EQ(gap.gap, look_along(gap, one, other));
    told += left.along > 0.0;
  }
  EXPECT_GT(told, 500);
}

// What stands beyond the points of a contact was never written.
TEST(HeldContact, IsArchivedByItsPointsAlone) {
  HeldContact one, other;
  one.count = other.count = 2;
  for (std::size_t i = 0; i < 4; ++i) {
    one.on_first[i] = one.on_second[i] = Eigen::Vector3f::Constant(float(i));
    other.on_first[i] = other.on_second[i] = Eigen::Vector3f::Constant(i < 2 ? float(i) : 7.0f);
  }
  StateArchive of_one, of_other;
  of_one(one), of_other(other);
  EXPECT_EQ(of_one.bytes(), of_other.bytes());
  HeldContact read;
  StateArchive reader(of_one.bytes(), {});
  reader(read);
  EXPECT_TRUE(reader.at_end());
  EXPECT_EQ(read.count, 2);
  EXPECT_EQ(read.on_second[1], one.on_second[1]);
}

}  // namespace
}  // namespace lodestone
