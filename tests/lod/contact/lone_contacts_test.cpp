// Bodies that touch nothing that moves: as ODE answers them, and each by itself.
#include "lod/contact/lone_contacts.h"

#include <gtest/gtest.h>

#include "lod/contact/crowd_solver.h"

namespace lodestone {
namespace {

constexpr double kLoneStep = 1.0 / 180.0;

struct LoneScene {
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
  std::vector<SolverContact> contacts() const {
    std::vector<SolverContact> all;
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
  void solve() { CrowdSolver().solve(bodies, manifolds, points, kLoneStep, {}, make_job_runner(1)); }
};

TEST(LoneContacts, FrictionIsBoundedAsInOde) {
  LoneScene lone;
  const std::int32_t body = lone.add_on_edge(), sleeper = lone.add_body(0.0, Vec3::Zero());
  const std::int32_t on_sleeper = lone.add_body(1.0, {0, 1, -1});
  lone.touch(sleeper, on_sleeper, -Vec3::UnitZ(), {{0, 0, 0.1}});
  std::vector<SolverBody> plain = lone.bodies;
  std::vector<SolverContact> contacts = lone.contacts();
  solve_contacts(plain, contacts, kLoneStep, {.sweeps = 500, .tolerance = 1e-9, .frictionless_bound = true});
  lone.solve();
  for (const std::int32_t i : {body, sleeper, on_sleeper}) {
    const auto at = std::size_t(i);
    EXPECT_LT((lone.bodies[at].velocity - plain[at].velocity).norm(), 1e-2) << i;
    EXPECT_LT((lone.bodies[at].angular_velocity - plain[at].angular_velocity).norm(), 1e-1) << i;
  }
  EXPECT_EQ(lone.bodies[std::size_t(sleeper)].velocity, Vec3::Zero());
  EXPECT_GT(lone.bodies[std::size_t(on_sleeper)].velocity.z(), 0.2);  // it bounces
  EXPECT_TRUE(lone.points.front().bounces);
}

TEST(LoneContacts, WhatElseThereIsChangesNothing) {
  LoneScene lone;
  lone.add_on_edge();
  LoneScene among = lone;
  among.add_on_edge();
  const std::int32_t weight = among.add_body(1e3, {0, 0, -1}), light = among.add_body(1.0, Vec3::Zero());
  among.touch(weight, light, Vec3::UnitZ(), {{0, 0, -0.1}});
  among.touch(light, -1, Vec3::UnitZ(), {{0, 0, -0.1}});
  lone.solve();
  among.solve();
  EXPECT_EQ(lone.bodies[0].velocity, among.bodies[0].velocity);
  EXPECT_EQ(lone.bodies[0].angular_velocity, among.bodies[0].angular_velocity);
  EXPECT_EQ(lone.bodies[0].velocity, among.bodies[1].velocity);  // its like
}

TEST(LoneContacts, GroundThatMovesCarriesABody) {
  LoneScene riding;
  const std::int32_t body = riding.add_body(1.0, Vec3::Zero()), belt = riding.add_body(0.0, {0.1, 0, 0});
  riding.touch(body, belt, Vec3::UnitZ(), {{0.1, 0.1, -0.1}, {-0.1, 0.1, -0.1}, {0, -0.1, -0.1}});
  for (int i = 0; i < 60; ++i) {
    riding.bodies[std::size_t(body)].velocity.z() -= 9.81 * kLoneStep;
    riding.solve();
  }
  EXPECT_NEAR(riding.bodies[std::size_t(body)].velocity.x(), 0.1, 2e-3);
  EXPECT_EQ(riding.bodies[std::size_t(belt)].velocity, Vec3(0.1, 0, 0));
}

}  // namespace
}  // namespace lodestone
