#include "lod/contact/crowd.h"

#include <gtest/gtest.h>

#include "tests/lod/contact/crowd_scene.h"

namespace lodestone::crowd_test {
namespace {

using testing::at;
using testing::box_shape;
using testing::CrowdScene;

constexpr double kCrowdStep = 1.0 / 240;
const Quat kAskew = rotation_from_vector(Vec3(0.2, 0.1, 0.4));

TEST(CrowdOfBoxes, AnImpactKeepsMomentumAndAngularMomentum) {
  for (const double mass : {1.0, 100.0}) {
    CrowdScene scene;
    const Participant a = scene.add(box_shape({0.2, 0.2, 0.2}), 1.0,
                                    at({-0.135, 0.03, 0.02}, {2, 0, 0}, {1, 2, 3}, kAskew)),
                      b = scene.add(box_shape({0.2, 0.3, 0.4}), mass, at({0.11, 0, 0}, {-1, 0, 0.5}));
    const Vec3 momentum = scene.momentum();
    // Apart, so that no overlap is undone; as positions move on with the new velocities, Σ m x × v stays the
    // same, too.
    const Vec3 angular = scene.angular_momentum();
    const double speed = (scene.bodies[0].velocity - scene.bodies[1].velocity).x();
    scene.step(kCrowdStep, {{a, b}});
    ASSERT_EQ(scene.contacts.size(), 1U);
    EXPECT_LT((scene.momentum() - momentum).norm(), 1e-12 * mass);
    EXPECT_LT((scene.angular_momentum() - angular).norm(), 1e-12 * mass);
    EXPECT_LT((scene.bodies[0].velocity - scene.bodies[1].velocity).x(), speed - 0.5);
  }
}

// Flat on each other, so that neither turns: e of the speed comes back.
TEST(CrowdOfBoxes, RestitutionIsThatOfTheMaterials) {
  for (const double restitution : {0.0, 0.5, 0.9}) {
    CrowdScene scene({restitution, 0.0});
    const auto cube = box_shape({0.2, 0.2, 0.2});
    const Participant a = scene.add(cube, 1.0, at({-0.1, 0, 0}, {1, 0, 0})),
                      b = scene.add(cube, 3.0, at({0.1, 0, 0}));
    scene.step(kCrowdStep, {{a, b}});
    EXPECT_NEAR((scene.bodies[1].velocity - scene.bodies[0].velocity).x(), restitution, 1e-3);
    EXPECT_NEAR(scene.bodies[0].velocity.x() + 3.0 * scene.bodies[1].velocity.x(), 1.0, 1e-12);
  }
}

TEST(CrowdOfBoxes, ASleeperIsGround) {
  CrowdScene scene({0.5, 0.0});
  const auto cube = box_shape({0.2, 0.2, 0.2});
  const Participant a = scene.add(cube, 1.0, at({-0.1, 0, 0}, {1, 0, 0})),
                    b = scene.add(cube, 1e-3, at({0.1, 0, 0}));
  scene.bodies[1].motion = Motion::asleep;
  scene.step(kCrowdStep, {{a, b}});
  EXPECT_NEAR(scene.bodies[0].velocity.x(), -0.5, 1e-3);
  EXPECT_EQ(scene.bodies[1].velocity, Vec3::Zero());
  EXPECT_EQ(scene.bodies[1].position, Vec3(0.1, 0, 0));
}

// What a full neighbour is given is what the statistical body lost: as a hit, as it bounces; it is not moved
// here.
TEST(CrowdOfBoxes, AFullNeighbourIsGivenTheOppositeImpulse) {
  for (const double speed : {1.0, 0.02}) {
    CrowdScene scene;
    const auto cube = box_shape({0.2, 0.2, 0.2});
    const Participant a = scene.add(cube, 2.0, at({-0.1, 0.05, 0}, {speed, 0, 0})),
                      b = scene.add_full(cube, 3.0, at({0.1, 0, 0}));
    scene.step(kCrowdStep, {{a, b}});
    const FullNeighbor& full = scene.neighbors[0];
    const Impulse &given = speed > 0.05 ? full.hit : full.push, &other = speed > 0.05 ? full.push : full.hit;
    EXPECT_LT((given.linear + scene.momentum() - Vec3(2 * speed, 0, 0)).norm(), 1e-12);
    EXPECT_GT(given.linear.x(), 0.1 * speed);
    EXPECT_EQ(other.linear, Vec3::Zero());
    EXPECT_NE(given.angular, Vec3::Zero());  // off its middle
    EXPECT_LT((full.mass * full.state.velocity - given.linear).norm(), 1e-12);
    EXPECT_EQ(full.state.position, Vec3(0.1, 0, 0));
  }
}

// What moves and is near it, but gives it nothing, does not keep it awake.
TEST(CrowdOfBoxes, OnlyWhoGivesAnImpulseMovesAFullNeighbour) {
  for (const double speed : {0.2, -0.2}) {
    CrowdScene scene;
    const auto cube = box_shape({0.2, 0.2, 0.2});
    const Participant a = scene.add(cube, 2.0, at({-0.1, 0, 0}, {speed, 0, 0})),
                      b = scene.add_full(cube, 3.0, at({0.1, 0, 0}));
    scene.step(kCrowdStep, {{a, b}});
    ASSERT_EQ(scene.contacts.size(), 1U);
    EXPECT_EQ(scene.neighbors[0].moved, speed > 0.0);
  }
}

// Three cubes on a plane, for two seconds: they stand, though nothing but this holds them.
TEST(CrowdOfBoxes, AStackStands) {
  CrowdScene scene;
  const auto cube = box_shape({0.2, 0.2, 0.2});
  const HalfSpace floor{};
  scene.world.gravity = {0, 0, -testing::kGravity};
  scene.world.planes = {&floor, 1};
  for (int i = 0; i < 3; ++i) scene.add(cube, 1.0 + i, at({0, 0, 0.1 + 0.2 * i}));
  const auto cube_at = [](std::size_t i) { return Participant::statistical(i); };
  const std::vector<std::pair<Participant, Participant>> pairs = {{cube_at(1), cube_at(0)},
                                                                  {cube_at(2), cube_at(1)}};
  for (int i = 0; i < 480; ++i) EXPECT_EQ(scene.step(kCrowdStep, pairs).contacts, 12);
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT((scene.bodies[i].position - Vec3(0, 0, 0.1 + 0.2 * i)).norm(), 1e-3) << i;
    EXPECT_LT(scene.bodies[i].velocity.norm(), 1e-3) << i;
  }
}

// μ g t off the speed of a box that slides, until it stands.
TEST(CrowdOfBoxes, FrictionBrakesWhatSlides) {
  CrowdScene scene({0.0, 0.3});
  const HalfSpace floor{};
  scene.world.gravity = {0, 0, -testing::kGravity};
  scene.world.planes = {&floor, 1};
  const auto slab = box_shape({0.4, 0.4, 0.02});  // which does not tip
  const Participant a = scene.add(slab, 1.0, at({0, 0, 0.01}, {0.5, 0, 0})),
                    b = scene.add(slab, 1.0, at({0, 0, 0.03}, {0.5, 0, 0}));
  const std::vector<std::pair<Participant, Participant>> pairs = {{b, a}};
  for (int i = 0; i < 24; ++i) scene.step(kCrowdStep, pairs);
  for (const StatisticalBody& body : scene.bodies)
    EXPECT_NEAR(body.velocity.x(), 0.5 - 0.3 * testing::kGravity * 0.1, 2e-3);
  for (int i = 0; i < 24; ++i) scene.step(kCrowdStep, pairs);
  for (const StatisticalBody& body : scene.bodies) EXPECT_NEAR(body.velocity.x(), 0.0, 1e-3);
}

// A quarter of it in a step, by masses: without adding a velocity.
TEST(CrowdOfBoxes, AnOverlapIsMovedApart) {
  CrowdScene scene;
  const auto cube = box_shape({0.2, 0.2, 0.2});
  const Participant a = scene.add(cube, 1.0, at({-0.095, 0, 0})), b = scene.add(cube, 3.0, at({0.095, 0, 0}));
  scene.step(kCrowdStep, {{a, b}});
  const double moved = scene.bodies[1].position.x() - scene.bodies[0].position.x() - 0.19,
               expected = push_out_overlap(-0.01, cube->radius);
  EXPECT_NEAR(moved, expected, 0.3 * expected);  // its points one after the other
  EXPECT_NEAR((-0.095 - scene.bodies[0].position.x()) / (scene.bodies[1].position.x() - 0.095), 3.0, 1e-6);
  EXPECT_LT(scene.bodies[0].velocity.norm(), 1e-9);
}

TEST(CrowdOfBoxes, AKinematicBodyIsMovedByNothing) {
  CrowdScene scene;
  OwnProperties own;
  own.set(2, BodyProperties{.kinematic = true});
  scene.world.properties = &own;
  const auto cube = box_shape({0.2, 0.2, 0.2});
  const Participant a = scene.add(cube, 1e3, at({-0.1, 0, 0}, {1, 0, 0})),
                    b = scene.add(cube, 1.0, at({0.1, 0, 0}, {-0.5, 0, 0}));
  scene.step(kCrowdStep, {{a, b}});
  EXPECT_EQ(scene.bodies[1].velocity, Vec3(-0.5, 0, 0));
  EXPECT_NEAR(scene.bodies[1].position.x(), 0.1 - 0.5 * kCrowdStep, 1e-12);
  EXPECT_LT(scene.bodies[0].velocity.x(), -0.5);
}

}  // namespace
}  // namespace lodestone::crowd_test
