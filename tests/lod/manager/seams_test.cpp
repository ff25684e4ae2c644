// Where solids of the ground lie flush, and where triangles of terrain meet, is nothing that anyone trips
// over.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "lod/manager.h"
#include "reference/random.h"
#include "tests/hills.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone::seams_test {
namespace {

constexpr double kCube = 0.3;  // m

std::shared_ptr<const Shape> cube(double side = kCube) { return testing::box_shape({side, side, side}); }

class Seams : public ::testing::TestWithParam<LevelChoice> {
 protected:
  Seams() { manager_.materials().replace(0, {.restitution = 0.4, .friction = 0.5}); }
  // Of a metre each, their tops at z = 0.
  void make_tiles() {
    for (int x = -3; x < 12; ++x)
      for (int y = -2; y < 2; ++y)
        manager_.add_static_box({1, 1, 1}, {x + 0.5, y + 0.5, -0.5}, Quat::Identity());
  }
  BodyId throw_cube(const Vec3& from, double speed) {
    RigidState state;
    state.position = from, state.velocity.x() = speed;
    return testing::add(manager_, cube(), state, GetParam());
  }
  bool is_support() const { return GetParam() == LevelChoice::support; }

  Manager manager_{{.events = {.all_bodies = true}, .signatures = testing::coarse_signature}};
};

// .8 m while every seam was met as a wall.
TEST_P(Seams, OfTilesDoNotStopWhatSlides) {
  make_tiles();
  double sum = 0.0;
  for (int i = 0; i < 4; ++i) {
    const BodyId body = throw_cube({0.1 * i, 0.3 * i - 0.5, 0.5 * kCube}, 4.0);
    testing::run(manager_, 2.0);
    sum += manager_.state(body).position.x() - 0.1 * i;
    EXPECT_NEAR(manager_.state(body).position.z(), 0.5 * kCube, 2e-3);
    manager_.remove_body(body);
  }
  EXPECT_NEAR(sum / 4, 1.63, 0.05);  // ODE in steps of 1/480 s
}

// Of two, the hind one runs into the other. `support` went 3.1 m, `tables`, whose cubes turn as they land,
// .9.
TEST_P(Seams, OfTilesDoNotStopTwoThatSlideBehindEachOther) {
  make_tiles();
  double sum = 0.0;
  constexpr int kPairs = 10;
  for (int i = 0; i < kPairs; ++i) {
    const Vec3 from(0.09 * i - 0.4, 0.2 * i - 1.0, 0.16);
    const std::vector<BodyId> pair{throw_cube(from, 7.0), throw_cube(from + 0.31 * Vec3::UnitX(), 7.0)};
    testing::run(manager_, 2.0);
    for (const BodyId body : pair) sum += 0.5 * (manager_.state(body).position.x() - from.x());
    for (const BodyId body : pair) manager_.remove_body(body);
  }
  EXPECT_NEAR(sum / kPairs, 5.15, is_support() ? 0.2 : 0.8);  // ODE in steps of 1/480 s
}

// Here the tile ahead is a step up.
TEST_P(Seams, AKerbStopsWhatSlides) {
  manager_.add_static_box({4, 4, 1}, {-2, 0, -0.5}, Quat::Identity());
  manager_.add_static_box({4, 4, 1}, {2, 0, -0.45}, Quat::Identity());
  const BodyId body = throw_cube({-1.0, 0, 0.5 * kCube}, 3.5);
  testing::run(manager_, 2.0);
  EXPECT_LT(manager_.state(body).position.x(), 0.0);
}

// Slopes of .2 at most, ridges of up to 11°: what strikes them strikes upwards.
TEST_P(Seams, RidgesOfHillsAreNoWalls) {
  manager_.add_static_mesh(testing::make_hills(40, 20));
  int walls = 0;
  double sum = 0.0;
  constexpr int kStarts = 12;
  for (int start = 0; start < kStarts; ++start) {
    RandomStream random(11, std::uint64_t(start), 0);
    const Vec3 from(random.uniform(-8, -4), random.uniform(-4, 4), 1.0);
    const std::vector<BodyId> pair{throw_cube(from, 20.0), throw_cube(from + 0.31 * Vec3::UnitZ(), 20.0)};
    for (int i = 0; i < 90; ++i) {
      manager_.step(testing::kFrame);
      for (const ContactEvent& event : manager_.contact_events())
        walls += event.second.kind != ContactSide::Kind::body && event.impulse > 5.0 &&
                 std::abs(event.normal.z()) < 0.5;
    }
    for (const BodyId body : pair) {
      sum += 0.5 * (manager_.state(body).position.x() - from.x());
      manager_.remove_body(body);
    }
  }
  EXPECT_EQ(walls, 0);
  EXPECT_GT(sum / kStarts, 17.0);  // of ODE's 20.6
}

// Pressed down by the blow, they met the edges of triangles six times as long as they are: a tenth turned
// back at `tables`.
TEST_P(Seams, OfHillsDoNotTurnBackWhatIsStruckThere) {
  manager_.add_static_mesh(testing::make_hills(20, 20));
  const auto ball = std::make_shared<const Shape>(make_sphere_shape(0.08));
  const auto small = cube(0.15);
  constexpr double kSpeed = 40.0;  // m/s
  int turned_back = 0;
  for (int start = 0; start < 60; ++start) {
    RandomStream random(13, std::uint64_t(start), 0);
    const double x = random.uniform(-6, 6), y = random.uniform(-6, 6), heading = random.uniform(0, 6.28);
    RigidState lying;
    lying.position = {x, y, testing::height_of_hills(x, y) + 0.1};
    lying.orientation = Eigen::AngleAxisd(random.uniform(0, 6), Vec3::UnitZ());
    const BodyId struck = testing::add(manager_, small, lying, GetParam());
    testing::run(manager_, 4.0);
    const Vec3 level(std::cos(heading), std::sin(heading), 0), across(-level.y(), level.x(), 0);
    const double down = random.uniform(0.15, 0.6);
    const Vec3 along = std::cos(down) * level - std::sin(down) * Vec3::UnitZ();
    RigidState coming;
    coming.position = manager_.state(struck).position - random.uniform(0.6, 1.4) * along +
                      random.uniform(-0.1, 0.1) * across + random.uniform(0, 0.08) * Vec3::UnitZ();
    coming.velocity = kSpeed * along;
    const BodyId striking =
        manager_.add_body({.shape = ball, .state = coming, .mass = 5.0, .level = GetParam()});
    double least = 0.0;  // m/s
    for (int i = 0; i < 30; ++i) {
      manager_.step(testing::kFrame);
      least = std::min(least, manager_.state(struck).velocity.dot(level));
    }
    turned_back += least < -0.1 * kSpeed;
    for (const BodyId body : {struck, striking}) manager_.remove_body(body);
  }
  EXPECT_EQ(turned_back, 0);
}

// Past the ridge that it would strike in passing it comes down on the triangle behind.
TEST_P(Seams, NorDoFastBallsPassThroughHills) {
  manager_.add_static_mesh(testing::make_hills(40, 20));
  const auto ball = std::make_shared<const Shape>(make_sphere_shape(0.08));
  int through = 0;
  for (int start = 0; start < 300; ++start) {
    RandomStream random(12, std::uint64_t(start), 0);
    RigidState state;
    state.position = {random.uniform(-1.5, -0.5), random.uniform(3.6, 4.6), random.uniform(0.17, 0.37)};
    state.velocity = {-22.3, 39.5, -8.3};
    const BodyId body = testing::add(manager_, ball, state, GetParam());
    for (int i = 0; i < 5; ++i) manager_.step(testing::kFrame);
    const Vec3 end = manager_.state(body).position;
    through += end.y() < 9.0 && end.z() < testing::height_of_hills(end.x(), end.y()) - 0.05;
    manager_.remove_body(body);
  }
  EXPECT_EQ(through, 0);
}

// Where all triangles round a corner seemed to have a neighbour that was nearer.
TEST_P(Seams, CornersOfHillsHoldWhatFallsOntoThem) {
  manager_.add_static_mesh(testing::make_hills(20, 20));
  const auto ball = std::make_shared<const Shape>(make_sphere_shape(0.08));
  std::vector<BodyId> bodies;
  for (int x = -9; x <= 9; ++x)
    for (int y = -9; y <= 9; ++y)
      bodies.push_back(testing::add(manager_, (x + y) % 2 ? ball : cube(0.15),
                                    testing::at({double(x), double(y), testing::height_of_hills(x, y) + 0.5}),
                                    GetParam()));
  testing::run(manager_, 0.5);
  for (const BodyId body : bodies) {
    const Vec3 place = manager_.state(body).position;
    EXPECT_GT(place.z(), testing::height_of_hills(place.x(), place.y()));
  }
}

// Across the corner of sixteen triangles, all of which turn less from each other than from what it meets.
TEST_P(Seams, APeakHoldsABall) {
  constexpr int kSides = 16;
  constexpr double kHeight = 0.6, kRadius = 0.2;  // m
  Mesh cone;
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kSides;
    cone.vertices.push_back({std::cos(angle), std::sin(angle), 0});
    cone.faces.push_back({i, (i + 1) % kSides, kSides});
  }
  const Vec3 apex(0, 0, kHeight);
  cone.vertices.push_back(apex);
  manager_.add_static_mesh(cone);
  const auto ball = std::make_shared<const Shape>(make_sphere_shape(kRadius));
  const BodyId body = testing::add(manager_, ball, testing::at({0.001, 0.0005, 1.2}), GetParam());
  double least = 1e300;
  for (int i = 0; i < 60; ++i) {
    manager_.step(testing::kFrame);
    least = std::min(least, (manager_.state(body).position - apex).norm());
  }
  EXPECT_GT(least, 0.98 * kRadius);
}

INSTANTIATE_TEST_SUITE_P(Rungs, Seams, ::testing::Values(LevelChoice::support, LevelChoice::tables),
                         [](const auto& instance) {
                           return instance.param == LevelChoice::support ? "support" : "tables";
                         });

}  // namespace
}  // namespace lodestone::seams_test
