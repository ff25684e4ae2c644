#include "lod/contact/footing.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

constexpr double kHalf = 0.1;  // m, of the sides of what stands here

/// What stands on what, from the arms of the points.
struct Standing {
  std::vector<SolverBody> bodies;
  std::vector<double> radii;
  std::vector<CrowdManifold> manifolds;
  std::vector<CrowdPoint> points;

  std::int32_t add_body(bool asleep = false) {
    bodies.push_back({.inverse_mass = asleep ? 0.0 : 1.0});
    radii.push_back(std::sqrt(3.0) * kHalf);
    return std::int32_t(bodies.size()) - 1;
  }
  // `lower` −1: the ground. Places are those of the points in the plane below the upper one's centre.
  void lay(std::int32_t upper, std::int32_t lower, const std::vector<std::array<double, 2>>& places,
           bool upper_first = true) {
    CrowdManifold& m = manifolds.emplace_back();
    m.first = upper_first ? upper : lower, m.second = upper_first ? lower : upper;
    m.normal = upper_first ? Vec3::UnitZ() : Vec3(-Vec3::UnitZ());
    m.begin = std::uint32_t(points.size()), m.count = std::uint32_t(places.size());
    for (const auto& [x, y] : places) {
      CrowdPoint& point = points.emplace_back();
      (upper_first ? point.arm_first : point.arm_second) = {x, y, -kHalf};
      (upper_first ? point.arm_second : point.arm_first) = {x, y, kHalf};
      point.impulse = m.normal;
    }
  }
  bool is_firm(std::int32_t body) const {
    Footing footing;
    footing.find(bodies, radii, manifolds, points, Vec3::UnitZ());
    return footing.is_firm(std::size_t(body));
  }
};

const std::vector<std::array<double, 2>> kFace{
    {-kHalf, -kHalf}, {kHalf, -kHalf}, {kHalf, kHalf}, {-kHalf, kHalf}},
    kEdge{{kHalf, -kHalf}, {kHalf, kHalf}}, kMiddleEdge{{0, -kHalf}, {0, kHalf}},
    kAside{{0.02, -kHalf}, {kHalf, -kHalf}, {kHalf, kHalf}, {0.02, kHalf}};

TEST(Footing, AnAreaUnderTheCentreIsFirmAndAnEdgeIsNot) {
  for (const bool upper_first : {true, false}) {
    Standing s;
    const std::int32_t flat = s.add_body(), edge = s.add_body(), middle = s.add_body(), aside = s.add_body(),
                       below = s.add_body(true), flying = s.add_body();
    const std::int32_t ground = upper_first ? -1 : below;
    s.lay(flat, ground, kFace, upper_first);
    s.lay(edge, ground, kEdge, upper_first);
    s.lay(middle, ground, kMiddleEdge, upper_first);
    s.lay(aside, ground, kAside, upper_first);
    EXPECT_TRUE(s.is_firm(flat));
    EXPECT_FALSE(s.is_firm(edge));
    EXPECT_FALSE(s.is_firm(middle));
    EXPECT_FALSE(s.is_firm(aside));
    EXPECT_FALSE(s.is_firm(flying));
    EXPECT_TRUE(s.is_firm(below));  // asleep
  }
}

TEST(Footing, WhatLiesOnOneThatTipsTipsWithIt) {
  Standing s;
  const std::int32_t bottom = s.add_body(), middle = s.add_body(), top = s.add_body(), beside = s.add_body();
  s.lay(top, middle, kFace);
  s.lay(middle, bottom, kFace, false);
  s.lay(bottom, -1, kEdge);
  s.lay(beside, -1, kFace);
  for (const std::int32_t body : {bottom, middle, top}) EXPECT_FALSE(s.is_firm(body));
  EXPECT_TRUE(s.is_firm(beside));
}

// Two that bear it from both sides are as good as one.
TEST(Footing, OfSeveralContactsTogether) {
  Standing s;
  const std::int32_t body = s.add_body(), left = s.add_body(true), right = s.add_body(true);
  s.lay(body, left, {{-kHalf, -kHalf}, {-kHalf, kHalf}});
  EXPECT_FALSE(s.is_firm(body));
  s.lay(body, right, kEdge);
  EXPECT_TRUE(s.is_firm(body));
}

// Shoved aside at its foot by a cube that then stops, and left to rock. (Of 81 speeds five end aslant.)
TEST(Footing, ATowerThatRocksDoesNotFallAsleepAslant) {
  using namespace testing;
  constexpr double kSide = 0.3, kWay = 0.6;  // m
  const auto cube = box_shape({kSide, kSide, kSide});
  int standing = 0, slant = 0;
  for (int i_speed = 0; i_speed < 20; ++i_speed) {
    const double speed = 0.30 + 0.0125 * i_speed;  // m/s
    Manager manager = on_floor();
    std::vector<BodyId> tower;
    for (int i = 0; i < 6; ++i)
      tower.push_back(add(manager, cube, testing::at({0, 0, kSide * (i + 0.5)}), LevelChoice::support));
    run(manager, 1.0);
    const BodyId pusher = manager.add_body({.shape = cube,
                                            .state = testing::at({-0.35, 0, 0.5 * kSide}, {speed, 0, 0}),
                                            .level = LevelChoice::support,
                                            .properties = {.kinematic = true}});
    run(manager, kWay / speed);
    manager.set_state(pusher, testing::at(manager.state(pusher).position));
    run(manager, 4.0);
    bool stands = true, is_slant = false;
    for (std::size_t i = 0; i < tower.size(); ++i) {
      const RigidState state = manager.state(tower[i]);
      const double upright = (state.orientation * Vec3::UnitZ()).z();
      stands = stands && state.position.z() > 0.95 * kSide * (double(i) + 0.5);
      is_slant = is_slant || (manager.asleep(tower[i]) && upright < std::cos(std::numbers::pi / 180));
    }
    standing += stands, slant += stands && is_slant;
  }
  EXPECT_GE(standing, 16);
  EXPECT_LE(slant, 3);
}

// Thin ones lift an edge by little where they are tilted by much.
TEST(Footing, APillarOnAnotherBodyDoesNotFallAsleepAslant) {
  using namespace testing;
  constexpr double kThickness = 0.2;  // m
  for (const Vec3& sides : {Vec3(0.1, 0.1, 0.8), Vec3(0.05, 0.3, 0.5)})
    for (const double share : {0.5, 0.8, 0.97}) {  // of the turning speed at which it would topple
      Manager manager = on_floor();
      manager.materials().replace(0, {.restitution = 0.2, .friction = 0.8});
      add(manager, box_shape({9, 1.5, kThickness}), testing::at({0, 0, 0.5 * kThickness}),
          LevelChoice::support);
      const auto pillar = box_shape(sides);
      const double half = 0.5 * sides.x(), height = 0.5 * sides.z(), arm = std::hypot(half, height),
                   inertia = pillar->inertia_per_mass(1, 1) + arm * arm,
                   turning = share * std::sqrt(2.0 * 9.81 * (arm - height) / inertia);  // rad/s
      RigidState state = testing::at({0, 0, kThickness + height});
      state.angular_velocity = Vec3(0, turning, 0);
      state.velocity = state.angular_velocity.cross(Vec3(-half, 0, height));
      const BodyId body = add(manager, pillar, state, LevelChoice::support);
      for (int i = 0; i < 600 && !manager.asleep(body); ++i) manager.step(kFrame);
      EXPECT_TRUE(manager.asleep(body));
      EXPECT_GT((manager.state(body).orientation * Vec3::UnitZ()).z(), std::cos(0.4 * std::numbers::pi / 180))
          << sides.transpose() << " at " << share;
    }
}

}  // namespace
}  // namespace lodestone
