#include "lod/contact/hull_gap.h"

#include <gtest/gtest.h>

#include "reference/hull/hull_overlap.h"
#include "reference/random.h"

namespace lodestone::hull_gap_test {
namespace {

Shape random_shape(RandomStream& random, int corners) {
  Mesh mesh;
  std::vector<Vec3> points;
  for (int i = 0; i < corners; ++i)
    points.push_back(Vec3(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5)
                         .cwiseProduct(Vec3(1.0, 0.6, 0.3)));
  const Hull hull = make_hull(points);
  mesh.vertices = hull.vertices;
  mesh.faces = hull.faces;
  return make_shape("hull", mesh);
}

Quat random_turn(RandomStream& random) {
  return Quat(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5)
      .normalized();
}

struct Pair {
  PlacedHull first, second;
  RigidState first_state() const { return {first.position, first.orientation}; }
  RigidState second_state() const { return {second.position, second.orientation}; }
  double overlap_after(const Vec3& shift) const {
    return measure_hull_overlap(*first.shape, {first.position + shift, first.orientation}, *second.shape,
                                second_state());
  }
};

class HullGapOfPairs : public ::testing::Test {
 protected:
  RandomStream random_{5, 0, 0};
  std::vector<Shape> shapes_ = [this] {
    std::vector<Shape> all;
    for (const int corners : {4, 8, 20, 60}) all.push_back(random_shape(random_, corners));
    all.push_back(make_shape("box", make_box({0.2, 0.3, 0.4})));
    all.push_back(make_sphere_shape(0.3));
    return all;
  }();

  Pair draw(double distance) {
    const Shape &a = shapes_[std::size_t(random_.uniform() * double(shapes_.size()))],
                &b = shapes_[std::size_t(random_.uniform() * double(shapes_.size()))];
    const Vec3 towards = random_turn(random_) * Vec3::UnitX();
    return {PlacedHull(a, distance * towards, random_turn(random_)),
            PlacedHull(b, Vec3::Zero(), random_turn(random_))};
  }
};

// No axis beside it, near or far, shows a greater gap; and along it they do not overlap before it is used up.
TEST_F(HullGapOfPairs, ApartItIsTheirDistance) {
  int apart = 0;
  for (int i = 0; i < 500; ++i) {
    Pair pair = draw(0.5 + random_.uniform());
    if (pair.overlap_after(Vec3::Zero()) > 0.0) continue;
    HullGap gap = find_hull_gap(pair.first, pair.second, {.normal = Vec3::Zero()}, 1e300);
    pair.first.position -= 0.99 * random_.uniform() * gap.gap * gap.normal;
    gap = find_hull_gap(pair.first, pair.second, {.normal = Vec3::Zero()}, 1e300);
    ++apart;
    ASSERT_GE(gap.gap, 0.0);
    EXPECT_NEAR(gap.normal.norm(), 1.0, 1e-12);
    EXPECT_EQ(pair.overlap_after(-(gap.gap - 1e-9) * gap.normal), 0.0);
    for (int k = 0; k < 40; ++k) {
      const Vec3 beside =
          (gap.normal + std::pow(10.0, -4.0 * random_.uniform()) * (random_turn(random_) * Vec3::UnitX()))
              .normalized();
      EXPECT_LE(measure_hull_gap(pair.first, pair.second, beside, gap).gap, gap.gap + 1e-6);
    }
  }
  EXPECT_GT(apart, 200);
}

TEST_F(HullGapOfPairs, OverlappingItIsNearTheLeastWayOut) {
  int overlapping = 0;
  for (int i = 0; i < 2000; ++i) {
    const Pair pair = draw(0.3 + 0.4 * random_.uniform());
    const double depth = pair.overlap_after(Vec3::Zero());
    if (depth == 0.0) continue;
    const HullGap gap = find_hull_gap(pair.first, pair.second, {.normal = Vec3::Zero()}, 1e300);
    ++overlapping;
    EXPECT_LE(gap.gap, 1e-9);
    EXPECT_LE(-gap.gap, 1.1 * depth + 0.01) << i << " depth " << depth;
    EXPECT_EQ(pair.overlap_after((-gap.gap + 1e-9) * gap.normal), 0.0);
  }
  EXPECT_GT(overlapping, 300);
}

TEST_F(HullGapOfPairs, AKnownAxisLeadsToTheSame) {
  for (int i = 0; i < 500; ++i) {
    const Pair pair = draw(0.8);
    const HullGap cold = find_hull_gap(pair.first, pair.second, {.normal = Vec3::Zero()}, 1e300);
    const HullGap warm = find_hull_gap(pair.first, pair.second, cold, 1e300);
    EXPECT_NEAR(warm.gap, cold.gap, 1e-6);
  }
}

TEST_F(HullGapOfPairs, EndsEarlyWhereAnAxisPartsThemByEnough) {
  const Pair pair{PlacedHull(shapes_[4], Vec3(0, 0, 5.0), Quat::Identity()),
                  PlacedHull(shapes_[4], Vec3::Zero(), Quat::Identity())};
  EXPECT_GT(find_hull_gap(pair.first, pair.second, {.normal = Vec3(0.6, 0.0, 0.8)}, 0.1).gap, 0.1);
  EXPECT_NEAR(measure_hull_gap(pair.first, pair.second, Vec3::UnitZ()).gap, 4.6, 1e-12);
}

// Boxes .3 m apart along z, an axis at 37° to that known, along which they are less far apart: who goes
// aside or away cannot close that gap; who comes nearer can, so that their true distance is looked for.
TEST_F(HullGapOfPairs, WhatIsEnoughHangsOnWhichWayTheyGo) {
  const Pair pair{PlacedHull(shapes_[4], Vec3(0, 0, 0.7), Quat::Identity()),
                  PlacedHull(shapes_[4], Vec3::Zero(), Quat::Identity())};
  const Vec3 slanting(0.6, 0.0, 0.8);
  const double along = measure_hull_gap(pair.first, pair.second, slanting).gap;
  ASSERT_GT(along, 0.05);
  ASSERT_LT(along, 0.2);
  const auto found = [&](const Vec3& way) {
    return find_hull_gap(pair.first, pair.second, {.normal = slanting}, Enough(0.05, way)).gap;
  };
  EXPECT_NEAR(found(Vec3(0.0, 1.0, 0.0)), along, 1e-12);
  EXPECT_NEAR(found(1.0 * slanting), along, 1e-12);
  EXPECT_NEAR(found(Vec3(0.0, 0.0, -1.0)), 0.3, 1e-9);
  const Enough enough(0.05, Vec3(-0.3, 0.0, 0.4));
  EXPECT_NEAR(enough.along(Vec3::UnitX()), 0.35, 1e-12);
  EXPECT_NEAR(enough.along(Vec3::UnitZ()), 0.05, 1e-12);
  EXPECT_NEAR(enough.anywhere(), 0.55, 1e-12);
}

}  // namespace
}  // namespace lodestone::hull_gap_test
