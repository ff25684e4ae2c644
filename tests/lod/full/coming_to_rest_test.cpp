// Full bodies on a plane come to rest.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "reference/random.h"
#include "tests/lod/manager/manager_fixture.h"
#include "tests/prism.h"

namespace lodestone {
namespace {

using namespace testing;

// More corners lie on the ground than a contact has points.
TEST(FullComesToRest, ACoinOfManyCornersLiesStill) {
  for (const int sides : {20, 32, 64}) {
    Manager manager = on_floor();
    const BodyId coin =
        add(manager, make_prism(sides, 0.1, 0.03), testing::at({0, 0, 0.016}), LevelChoice::full);
    run(manager, 2.0);
    EXPECT_TRUE(manager.asleep(coin)) << sides;
  }
}

// Who has company is met by the substep, not at its own time within it.
TEST(FullComesToRest, ACoinBesideAnother) {
  for (const int sides : {20, 24}) {
    RandomStream random(4, std::uint32_t(sides), 0);
    const auto prism = make_prism(sides, 0.12, 0.02);
    const auto turned = [](double angle, const Vec3& axis) { return Quat(Eigen::AngleAxisd(angle, axis)); };
    Manager manager = on_floor();
    manager.materials().replace(0, {.restitution = 0.2, .friction = 0.5});
    std::vector<BodyId> coins;
    for (int i = 0; i < 12; ++i)
      coins.push_back(
          add(manager, prism,
              {.position = Vec3(i % 2 * 0.2424, 2.0 * (i / 2), 0.05),
               .orientation = turned(6.0 * random.uniform(), Vec3::UnitZ()) * turned(0.17, Vec3::UnitX()) *
                              turned(6.0 * random.uniform(), Vec3::UnitZ())},
              LevelChoice::full));
    run(manager, 8.0);
    EXPECT_TRUE(std::ranges::all_of(coins, [&](BodyId coin) { return manager.asleep(coin); })) << sides;
  }
}

/// How many of `count` full bodies are awake after `seconds`, poured into a bin 1.33 m wide.
int count_awake_in_bin(const std::shared_ptr<const Shape>& shape, int count, double seconds,
                       std::uint32_t seed) {
  Manager manager = on_floor();
  for (const Vec3& inward : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)})
    manager.add_plane(inward, -0.665);
  RandomStream random(seed, 5, 0);
  for (int i = 0; i < count; ++i) {
    const Vec3 cell(i % 3 - 1, i / 3 % 3 - 1, i / 9);
    add(manager, shape,
        {.position = Vec3(0, 0, 0.5) + cell.cwiseProduct(Vec3(0.42, 0.42, 0.5)) +
                     0.03 * Vec3(random.uniform(), random.uniform(), 0.0),
         .orientation = random.orientation()},
        LevelChoice::full);
  }
  run(manager, seconds);
  return count - manager.report().asleep;
}

// QuickStep leaves of each contact an error of some micrometres a substep: pushed apart to nothing, bodies
// were parted by it, fell for a substep and landed, so that none of these slept.
TEST(FullComesToRest, HeapsThatQuickStepSolves) {
  constexpr int kPours = 3;
  const auto ball = std::make_shared<const Shape>(make_sphere_shape(0.15));
  const auto l = std::make_shared<const Shape>(make_shape("l", make_l(0.4, 0.3, 0.1, 0.1)));
  for (std::uint32_t seed = 0; seed < kPours; ++seed) {
    EXPECT_LE(count_awake_in_bin(ball, 60, 6.0, seed), 3) << seed;
    EXPECT_LE(count_awake_in_bin(l, 30, 6.0, seed), 3) << seed;
  }
}

/// A ditch along y, 1 m deep, .4 m wide above and .2 m below, in level ground; an open sheet.
Mesh make_ditch() {
  Mesh ditch;
  const double x[] = {-3.0, -0.2, -0.1, 0.1, 0.2, 3.0}, z[] = {0.0, 0.0, -1.0, -1.0, 0.0, 0.0};
  for (const double y : {-2.0, 2.0})
    for (int i = 0; i < 6; ++i) ditch.vertices.push_back({x[i], y, z[i]});
  for (int i = 0; i < 5; ++i) {
    ditch.faces.push_back({i, i + 1, i + 6});
    ditch.faces.push_back({i + 1, i + 7, i + 6});
  }
  return ditch;
}

// Both walls press, against each other: neither says the way out for both.
TEST(FullComesToRest, BetweenTheWallsOfAMesh) {
  const auto crate = box_shape({0.3, 0.3, 0.3});
  for (int k = 0; k < 8; ++k) {
    Manager manager(unmeasured());
    manager.add_static_mesh(make_ditch());
    const Quat yaw(Eigen::AngleAxisd(k < 4 ? 0.0 : 0.3, Vec3::UnitZ()));
    const BodyId body = add(manager, crate, {.position = Vec3(0.02 * (k % 4), 0.0, 0.5), .orientation = yaw},
                            LevelChoice::full);
    const double mass = manager.mass(body);
    double before = 1e9;  // J/kg
    for (int i = 0; i < 360; ++i) {
      manager.step(kFrame);
      const double now = energy(manager, body) / mass;
      ASSERT_LT(now - before, 0.2) << k << ", step " << i;
      before = now;
    }
    EXPECT_TRUE(manager.asleep(body)) << k;
  }
}

// Restitution gives back no more than a vertex brought, however slow.
TEST(FullComesToRest, AtRestitutionPointNine) {
  RandomStream random(3, 0, 0);
  Manager manager = on_floor();
  manager.materials().replace(0, {.restitution = 0.9, .friction = 0.5});
  const auto prism = make_prism(3, 0.06, 0.5);
  std::vector<BodyId> bodies;
  for (int i = 0; i < 20; ++i)
    bodies.push_back(add(manager, prism,
                         {.position = Vec3(2.0 * i, 0, 1), .orientation = random.orientation()},
                         LevelChoice::full));
  run(manager, 12.0);
  EXPECT_LE(std::ranges::count_if(bodies, [&](BodyId body) { return !manager.asleep(body); }), 1);
}

// On the moon it falls over slowly: two degrees beyond its balance it was put to sleep at 12.6°.
TEST(FullComesToRest, NobodyLeaningOnNothingUnderLittleGravity) {
  constexpr double kBeyond = 2.0 * std::numbers::pi / 180.0;  // rad
  const Vec3 sides(0.1, 0.3, 0.6);                            // m
  const double balance = std::atan2(sides.x(), sides.z()), tilt = balance + kBeyond;
  Manager manager({.gravity = {0, 0, -1.62}, .signatures = no_signature});
  manager.add_plane(Vec3::UnitZ(), 0.0);
  manager.materials().replace(0, {.restitution = 0.4, .friction = 0.8});
  RigidState leaning;
  leaning.orientation = Quat(Eigen::AngleAxisd(tilt, Vec3::UnitY()));
  leaning.position.z() = 0.5 * (sides.x() * std::sin(tilt) + sides.z() * std::cos(tilt));
  const BodyId domino = add(manager, box_shape(sides), leaning, LevelChoice::full);
  run(manager, 12.0);
  EXPECT_NEAR(manager.state(domino).position.z(), 0.5 * sides.x(), 0.01);
}

}  // namespace
}  // namespace lodestone
