#include "lod/contact/borne_weights.h"

#include <gtest/gtest.h>

namespace lodestone {
namespace {

constexpr double kStepOfFall = 0.01;  // s
const Vec3 kFall(0.0, 0.0, -0.1);     // m/s: what gravity adds in it

/// Bodies, all at rest but for what gravity has just added, and what lies on what.
struct Built {
  std::vector<SolverBody> bodies;
  std::vector<CrowdManifold> manifolds;
  std::vector<CrowdPoint> points;

  std::int32_t add_body(double mass) {
    bodies.push_back({.velocity = kFall, .inverse_mass = 1.0 / mass, .inverse_inertia = Mat3::Identity()});
    return std::int32_t(bodies.size()) - 1;
  }
  // `lower` −1: the ground. By the lower body's side the normal points the other way.
  CrowdManifold& lay(std::int32_t upper, std::int32_t lower, int count, bool upper_first = true) {
    CrowdManifold& m = manifolds.emplace_back();
    m.first = upper_first ? upper : lower, m.second = upper_first ? lower : upper;
    m.normal = upper_first ? Vec3::UnitZ() : Vec3(-Vec3::UnitZ());
    m.begin = std::uint32_t(points.size()), m.count = std::uint32_t(count);
    points.resize(points.size() + std::size_t(count));
    return m;
  }
  void guess() { BorneWeights().guess(bodies, manifolds, points, kFall, kStepOfFall); }
  Vec3 of(std::size_t manifold) const {
    Vec3 sum = Vec3::Zero();
    for (std::uint32_t i = 0; i < manifolds[manifold].count; ++i)
      sum += points[manifolds[manifold].begin + i].guess;
    return sum;
  }
};

TEST(BorneWeights, ATowersContactsBearAllThatIsAbove) {
  Built tower;
  for (const double mass : {1.0, 2.0, 4.0}) tower.add_body(mass);  // from below
  tower.lay(2, 1, 4);
  tower.lay(1, 0, 3, false);
  tower.lay(0, -1, 4);
  tower.guess();
  EXPECT_LT((tower.of(0) - Vec3(0, 0, 0.4)).norm(), 1e-15);
  EXPECT_LT((tower.of(1) - Vec3(0, 0, -0.6)).norm(), 1e-15);  // on the first of the two, the lower one
  EXPECT_LT((tower.of(2) - Vec3(0, 0, 0.7)).norm(), 1e-15);
  EXPECT_LT((tower.points[0].guess - Vec3(0, 0, 0.1)).norm(), 1e-15);  // in equal parts
}

TEST(BorneWeights, WhatLiesOnTwoIsHalvedAndGoesOn) {
  Built arch;
  for (int i = 0; i < 3; ++i) arch.add_body(1.0);
  arch.lay(2, 0, 2), arch.lay(2, 1, 2), arch.lay(0, -1, 4), arch.lay(1, -1, 4);
  arch.guess();
  EXPECT_NEAR(arch.of(0).z(), 0.05, 1e-15);
  EXPECT_NEAR(arch.of(2).z(), 0.15, 1e-15);
  EXPECT_NEAR(arch.of(3).z(), 0.15, 1e-15);
}

TEST(BorneWeights, KnownContactsBearWhatTheyBore) {
  Built pair;
  pair.add_body(1.0), pair.add_body(1.0);
  pair.lay(1, 0, 1), pair.lay(0, -1, 1).known = true, pair.lay(0, -1, 1);
  pair.points[1].guess = Vec3(0, 0, 0.15);
  pair.guess();
  EXPECT_NEAR(pair.of(0).z(), 0.1, 1e-15);
  EXPECT_EQ(pair.of(1), Vec3(0, 0, 0.15));
  EXPECT_NEAR(pair.of(2).z(), 0.05, 1e-15);  // what is left of both weights
}

TEST(BorneWeights, NothingThatComesDownFastOrThatIsApartOrSteepIsGuessed) {
  Built three;
  for (int i = 0; i < 3; ++i) three.add_body(1.0);
  three.lay(0, -1, 1), three.lay(1, -1, 1), three.lay(2, -1, 1);
  three.bodies[0].velocity = Vec3(0, 0, -1.0);
  three.points[1].gap = 0.01;  // m
  three.manifolds[2].normal = Vec3::UnitX();
  three.guess();
  for (const CrowdPoint& point : three.points) EXPECT_EQ(point.guess, Vec3::Zero());
}

TEST(BorneWeights, BodiesOnEachOtherInACircleAreLeftOut) {
  Built circle;
  circle.add_body(1.0), circle.add_body(1.0);
  circle.lay(0, 1, 1), circle.lay(1, 0, 1);
  circle.guess();
  for (const CrowdPoint& point : circle.points) EXPECT_EQ(point.guess, Vec3::Zero());
}

}  // namespace
}  // namespace lodestone
