// Few bodies that hang together: as ODE answers them, and each island by itself.
#include "lod/contact/small_islands.h"

#include <gtest/gtest.h>

#include "lod/contact/crowd_solver.h"
#include "tests/lod/contact/plain_solver.h"

namespace lodestone {
namespace {

constexpr double kIslandStep = 1.0 / 180.0;

struct IslandScene {
  std::vector<SolverBody> bodies;
  std::vector<CrowdManifold> manifolds;
  std::vector<CrowdPoint> points;

  std::int32_t add_body(double mass, const Vec3& velocity) {
    SolverBody& body = bodies.emplace_back();
    body.velocity = velocity;
    body.inverse_mass = mass > 0.0 ? 1.0 / mass : 0.0;
    body.inverse_inertia = Mat3::Identity() * (60.0 * body.inverse_mass);
    return std::int32_t(bodies.size()) - 1;
  }
  void touch(std::int32_t first, std::int32_t second, const Vec3& normal, std::initializer_list<Vec3> arms) {
    manifolds.push_back({.first = first,
                         .second = second,
                         .normal = normal,
                         .law = {.restitution = 0.3, .friction = 0.6},
                         .begin = std::uint32_t(points.size()),
                         .count = std::uint32_t(arms.size())});
    for (const Vec3& arm : arms) points.push_back({.arm_first = arm, .arm_second = Vec3(0, 0, -0.1)});
  }
  // A body that falls onto the edge of a step.
  std::int32_t add_on_edge(std::int32_t step = -1) {
    const std::int32_t body = add_body(2.0, {1.5, 0.2, -2});
    touch(body, step, Vec3(0.6, 0, 0.8), {{-0.1, -0.1, -0.05}, {-0.1, 0.1, -0.05}});
    touch(body, -1, Vec3::UnitZ(), {{0.1, 0, -0.1}});
    return body;
  }
  std::vector<PlainContact> contacts() const {
    std::vector<PlainContact> all;
    for (const CrowdManifold& m : manifolds)
      for (const CrowdPoint& p : std::span(points).subspan(m.begin, m.count))
        all.push_back({.first = m.first,
                       .second = m.second,
                       .normal = m.normal,
                       .arm_first = p.arm_first,
                       .arm_second = p.arm_second,
                       .law = m.law});
    return all;
  }
  // Two bodies, one lying on the ground, the other thrown onto it, which is half beside it.
  std::int32_t add_pair() {
    const std::int32_t lower = add_body(2.0, {0, 0, -0.05}), upper = add_body(1.5, {2, 0.3, -1.5});
    touch(lower, -1, Vec3::UnitZ(), {{0.1, 0.1, -0.1}, {-0.1, 0.1, -0.1}, {0, -0.1, -0.1}});
    touch(upper, lower, Vec3::UnitZ(), {{-0.1, 0.05, -0.1}, {-0.05, -0.05, -0.1}});
    return lower;
  }
  void solve(Simd simd = find_simd(), int threads = 1) {
    CrowdSolver(simd).solve(bodies, manifolds, points, kIslandStep, {}, make_job_runner(threads));
  }
};

TEST(SmallIslands, FrictionIsBoundedAsInOde) {
  IslandScene islands;
  const std::int32_t body = islands.add_on_edge(), sleeper = islands.add_body(0.0, Vec3::Zero());
  const std::int32_t on_sleeper = islands.add_body(1.0, {0, 1, -1}), pair = islands.add_pair();
  islands.touch(sleeper, on_sleeper, -Vec3::UnitZ(), {{0, 0, 0.1}});
  std::vector<SolverBody> plain = islands.bodies;
  std::vector<PlainContact> contacts = islands.contacts();
  // What lies on the ground carries its weight to it already: no blow goes on through it (ImpactWaves).
  for (const CrowdManifold& m : islands.manifolds)
    for (CrowdPoint& p : std::span(islands.points).subspan(m.begin, m.first == pair ? m.count : 0))
      p.guess = Vec3(0, 0, 2.0 * 9.81 * kIslandStep / m.count);
  solve_plainly(plain, contacts, kIslandStep, {.sweeps = 500, .tolerance = 1e-9, .frictionless_bound = true});
  islands.solve();
  for (const std::int32_t i : {body, sleeper, on_sleeper, pair, pair + 1}) {
    const auto at = std::size_t(i);
    EXPECT_LT((islands.bodies[at].velocity - plain[at].velocity).norm(), 1e-2) << i;
    EXPECT_LT((islands.bodies[at].angular_velocity - plain[at].angular_velocity).norm(), 1e-1) << i;
  }
  EXPECT_EQ(islands.bodies[std::size_t(sleeper)].velocity, Vec3::Zero());
  EXPECT_GT(islands.bodies[std::size_t(on_sleeper)].velocity.z(), 0.2);  // it bounces
  EXPECT_TRUE(islands.points.front().bounces);
  for (const CrowdPoint& point : islands.points) EXPECT_GE(point.frictionless, 0.0F);
}

// From one body to the other and to the ground, and nothing else.
TEST(SmallIslands, ImpulsesActBothWays) {
  IslandScene islands;
  const auto lower = std::size_t(islands.add_pair());
  const auto momentum = [&] {
    return Vec3(2.0 * islands.bodies[lower].velocity + 1.5 * islands.bodies[lower + 1].velocity);
  };
  const Vec3 before = momentum();
  islands.solve();
  Vec3 given = Vec3::Zero();  // by the ground
  for (std::size_t i = 0; i < 3; ++i) given += islands.points[i].impulse;
  EXPECT_GT(given.z(), 0.5);
  EXPECT_LT((momentum() - before - given).norm(), 1e-12);
}

TEST(SmallIslands, HaveOneResultForEveryInstructionSetAndNumberOfThreads) {
  IslandScene portable;
  for (int i = 0; i < 100; ++i) {
    portable.add_on_edge();
    const auto lower = std::size_t(portable.add_pair());
    portable.bodies[lower + 1].velocity.x() += 0.01 * i;
  }
  const IslandScene start = portable;
  portable.solve(Simd::portable);
  for (const Simd simd : {Simd::portable, Simd::avx2, Simd::avx512}) {
    if (simd > find_simd()) continue;
    for (const int threads : {1, 3}) {
      IslandScene islands = start;
      islands.solve(simd, threads);
      for (std::size_t i = 0; i < islands.bodies.size(); ++i) {
        ASSERT_EQ(islands.bodies[i].velocity, portable.bodies[i].velocity) << i << ' ' << int(simd);
        ASSERT_EQ(islands.bodies[i].angular_velocity, portable.bodies[i].angular_velocity) << i;
      }
    }
  }
}

TEST(SmallIslands, WhatElseThereIsChangesNothing) {
  IslandScene islands;
  islands.add_on_edge();
  IslandScene among = islands;
  among.add_on_edge();
  const std::int32_t weight = among.add_body(1e3, {0, 0, -1}), light = among.add_body(1.0, Vec3::Zero());
  among.touch(weight, light, Vec3::UnitZ(), {{0, 0, -0.1}});
  among.touch(light, -1, Vec3::UnitZ(), {{0, 0, -0.1}});
  islands.solve();
  among.solve();
  EXPECT_EQ(islands.bodies[0].velocity, among.bodies[0].velocity);
  EXPECT_EQ(islands.bodies[0].angular_velocity, among.bodies[0].angular_velocity);
  EXPECT_EQ(islands.bodies[0].velocity, among.bodies[1].velocity);  // its like
}

// What moves by its own rule and what sleeps: neither can be pushed.
TEST(SmallIslands, TwoThatNothingMovesGiveEachOtherNothing) {
  IslandScene islands;
  const std::int32_t moving = islands.add_body(0.0, {0, 0, -1}),
                     sleeper = islands.add_body(0.0, Vec3::Zero());
  islands.touch(moving, sleeper, Vec3::UnitZ(), {{0, 0, -0.1}});
  islands.solve();
  EXPECT_EQ(islands.points[0].impulse, Vec3::Zero());
  EXPECT_EQ(islands.bodies[std::size_t(moving)].velocity, Vec3(0, 0, -1));
  EXPECT_EQ(islands.bodies[std::size_t(sleeper)].velocity, Vec3::Zero());
}

TEST(SmallIslands, GroundThatMovesCarriesABody) {
  IslandScene riding;
  const std::int32_t body = riding.add_body(1.0, Vec3::Zero()), belt = riding.add_body(0.0, {0.1, 0, 0});
  riding.touch(body, belt, Vec3::UnitZ(), {{0.1, 0.1, -0.1}, {-0.1, 0.1, -0.1}, {0, -0.1, -0.1}});
  for (int i = 0; i < 60; ++i) {
    riding.bodies[std::size_t(body)].velocity.z() -= 9.81 * kIslandStep;
    riding.solve();
  }
  EXPECT_NEAR(riding.bodies[std::size_t(body)].velocity.x(), 0.1, 2e-3);
  EXPECT_EQ(riding.bodies[std::size_t(belt)].velocity, Vec3(0.1, 0, 0));
}

}  // namespace
}  // namespace lodestone
