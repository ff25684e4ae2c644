// A tree of triangles, against closed forms and against a look at every triangle.
#include "lod/queries/triangle_tree.h"

#include <gtest/gtest.h>

#include "reference/random.h"

namespace lodestone::triangle_tree_test {
namespace {

const Vec3 kSides{0.2, 0.3, 0.4};

Vec3 random_point(RandomStream& random, double reach) {
  return {random.uniform(-reach, reach), random.uniform(-reach, reach), random.uniform(-reach, reach)};
}

// m: of a point to the surface of a box; negative inside.
double distance_to_box(const Vec3& p, const Vec3& sides) {
  const Vec3 beyond = p.cwiseAbs() - 0.5 * sides;
  return beyond.maxCoeff() > 0.0 ? beyond.cwiseMax(0.0).norm() : beyond.maxCoeff();
}

TEST(TriangleTree, NearestPointAndInsideOfABox) {
  const TriangleTree tree(make_box(kSides));
  RandomStream random(1, 0, 0);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p = random_point(random, 0.4);
    const double expected = distance_to_box(p, kSides);
    EXPECT_EQ(tree.contains(p), expected < 0.0);
    const auto nearest = tree.ask(NearestPoint(p, 10.0)).hit();
    ASSERT_TRUE(nearest);
    EXPECT_NEAR(nearest->distance, std::abs(expected), 1e-12);
    EXPECT_EQ(tree.ask(NearestPoint(p, std::abs(expected) * 0.999)).hit().has_value(), false);
  }
}

TEST(TriangleTree, RaysMeetASphereWhereTheyShould) {
  const TriangleTree tree(make_sphere(1.0, 5));
  RandomStream random(2, 0, 0);
  int met = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 from = 3.0 * random.direction(), direction = (random_point(random, 1.2) - from).normalized();
    const auto hit = tree.ask(FirstMet(from, direction, 10.0)).hit();
    const auto expected = meet_sphere(from, direction, 10.0, Vec3::Zero(), 1.0);
    if (!expected || !hit) continue;
    ++met;
    const double grazing = -direction.dot(hit->normal);
    EXPECT_NEAR(hit->distance, *expected, 3e-3 / std::max(0.05, grazing));
    EXPECT_LT((hit->point - from - hit->distance * direction).norm(), 1e-12);
    EXPECT_FALSE(tree.ask(FirstMet(from, direction, hit->distance * 0.999)).hit());
  }
  EXPECT_GT(met, 800);
}

TEST(TriangleTree, RayFromInsideMeetsNothing) {
  const TriangleTree tree(make_box(kSides));
  RandomStream random(3, 0, 0);
  for (int i = 0; i < 200; ++i)
    EXPECT_FALSE(tree.ask(FirstMet(random_point(random, 0.09), random.direction(), 10.0)).hit());
}

// Where it stops it touches, and before it did not.
TEST(TriangleTree, SweptSphereStopsAtFirstTouch) {
  const TriangleTree tree(make_l(0.4, 0.4, 0.1, 0.2));
  RandomStream random(4, 0, 0);
  int met = 0, passed = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 from = 1.5 * random.direction(), direction = (random_point(random, 0.4) - from).normalized();
    const double radius = random.uniform(0.01, 0.3), length = 3.0;
    const auto hit = tree.ask(FirstMet(from, direction, length, radius)).hit();
    const double until = hit ? hit->distance : length;
    double least = 1e9;
    for (double at = 0.0; at < until - 1e-6; at += 0.01)
      least = std::min(least, tree.ask(NearestPoint(from + at * direction, 10.0)).hit()->distance);
    EXPECT_GT(least, radius - 1e-9);
    if (!hit) {
      ++passed;
      continue;
    }
    ++met;
    const Vec3 center = from + hit->distance * direction;
    EXPECT_NEAR(tree.ask(NearestPoint(center, 10.0)).hit()->distance, radius, 1e-9);
    EXPECT_NEAR((center - hit->point).norm(), radius, 1e-9);
    EXPECT_LT(hit->normal.dot(direction), 1e-6);
  }
  EXPECT_GT(met, 1000);
  EXPECT_GT(passed, 300);
}

TEST(TriangleTree, BoxesAgainstPointsOfBoth) {
  const TriangleTree tree(make_box(kSides));
  RandomStream random(5, 0, 0);
  int both = 0, neither = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 center = random_point(random, 0.5),
               half(random.uniform(0.02, 0.2), random.uniform(0.02, 0.2), random.uniform(0.02, 0.2));
    const Mat3 axes = random.orientation().toRotationMatrix();
    const bool meets = tree.ask(MeetsBox(center, axes, half)).met() || tree.contains(center);
    // Points within the one that lie within the other.
    bool shared = false;
    for (int k = 0; k < 400 && !shared; ++k) {
      const Vec3 own(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      shared = distance_to_box(center + axes * own.cwiseProduct(half), kSides) < 0.0;
    }
    EXPECT_TRUE(!shared || meets);
    const double apart = (center.norm() - half.norm() - 0.5 * kSides.norm());
    EXPECT_FALSE(apart > 0.0 && meets);
    both += shared, neither += apart > 0.0;
  }
  EXPECT_GT(both, 200);
  EXPECT_GT(neither, 100);
}

}  // namespace
}  // namespace lodestone::triangle_tree_test
