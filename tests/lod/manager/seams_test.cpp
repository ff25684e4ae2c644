// Where solids of the ground lie flush, and where triangles of terrain meet, is nothing that anyone trips
// over.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
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

// 20° down to x = 0, z = 0, on a base of .3 m.
Mesh make_ramp() {
  constexpr double kLength = 3.0, kBase = 0.3, kWidth = 2.0, kRise = 0.36397;  // m; of 20°
  Mesh ramp;
  for (const double y : {-0.5 * kWidth, 0.5 * kWidth})
    for (const auto& [x, z] :
         {std::pair{-kLength, -kBase}, {0.0, -kBase}, {0.0, 0.0}, {-kLength, kRise * kLength}})
      ramp.vertices.push_back({x, y, z});
  const auto add = [&](int a, int b, int c, int d) {
    ramp.faces.push_back({a, b, c});
    ramp.faces.push_back({a, c, d});
  };
  add(0, 1, 2, 3), add(4, 7, 6, 5), add(0, 4, 5, 1), add(1, 5, 6, 2), add(2, 6, 7, 3), add(3, 7, 4, 0);
  return ramp;
}

// The least part of its speed, of a few starts, that a crate keeps from .6 m before a ramp's foot to .25 m
// behind it, the floor a box whose top is at `floor` (m).
double slide_over_foot(Manager& manager, LevelChoice level, bool down, bool two, double floor) {
  manager.materials().replace(0, {.restitution = 0.3, .friction = 0.1});
  manager.add_static_mesh(make_ramp());
  manager.add_static_box({12, 2, 0.3}, {6, 0, floor - 0.15}, Quat::Identity());
  const auto crate = testing::box_shape({0.2, 0.3, 0.15});
  const Quat along(Eigen::AngleAxisd(down ? std::numbers::pi / 9 : 0.0, Vec3::UnitY()));
  double least = 1e300;
  for (std::uint32_t i = 0; i < 8; ++i) {
    RandomStream random(5, i, 0);
    RigidState state;
    const double from = random.uniform(0.6, 0.66), speed = down ? random.uniform(2.5, 3.5) : 4.0;
    const Quat turn(Eigen::AngleAxisd(two ? 0.0 : random.uniform(-1.5, 1.5), Vec3::UnitZ()));
    state.position = along * Vec3(down ? -from : from, 0, 0.0751) + (down ? 0.0 : floor) * Vec3::UnitZ();
    state.velocity = along * Vec3(down ? speed : -speed, 0, 0);
    state.orientation = along * turn;
    std::vector<BodyId> bodies{testing::add(manager, crate, state, level)};
    state.position += state.orientation * Vec3(0, 0.3005, 0);
    if (two) bodies.push_back(testing::add(manager, crate, state, level));
    const auto place = [&] { return manager.state(bodies[0]).position.x() * (down ? 1.0 : -1.0); };
    for (int k = 0; k < 36 && place() < 0.25; ++k) manager.step(testing::kFrame);
    least = std::min(least, place() < 0.25 ? 0.0 : manager.state(bodies[0]).velocity.norm() / speed);
    for (const BodyId body : bodies) manager.remove_body(body);
  }
  return least;
}

// The tile's upper edge, which the ramp covers, was met as any other: two in three tripped and lost most of
// their speed. At full 24 starts keep 1.02 of it down, .78 up, none less than .75. Of two of `tables` some
// still trip.
TEST_P(Seams, FeetOfRampsDoNotStopWhatSlides) {
  for (const bool down : {true, false})
    for (const bool two : {false, is_support()})
      for (const double floor : {0.0, 1e-4, -1e-4}) {
        Manager manager({.signatures = testing::coarse_signature});
        EXPECT_GT(slide_over_foot(manager, GetParam(), down, two, floor), down ? 0.9 : 0.7)
            << down << two << floor;
      }
}

TEST_P(Seams, AKerbAtTheFootOfARampStopsWhatSlides) {
  Manager manager({.signatures = testing::coarse_signature});
  EXPECT_EQ(slide_over_foot(manager, GetParam(), true, false, 0.06), 0.0);
}

// The part of its speed that a crate keeps over 1.5 m of a row of bodies that lie flush, .3 m high and each
// .3 m long (m, x from -.15 on), a mean of a few starts; none where it does not come so far.
double slide_over_row(Manager& manager, LevelChoice level) {
  const auto crate = testing::box_shape({0.2, 0.3, 0.15});
  double sum = 0.0;
  constexpr std::uint32_t kStarts = 6;
  for (std::uint32_t i = 0; i < kStarts; ++i) {
    RandomStream random(6, i, 0);
    RigidState state;
    const double speed = random.uniform(2.5, 3.5);
    state.position = {0, 0, 0.3751}, state.velocity.x() = speed;
    state.orientation = Quat(Eigen::AngleAxisd(random.uniform(-1.5, 1.5), Vec3::UnitZ()));
    const BodyId body = testing::add(manager, crate, state, level);
    const auto place = [&] { return manager.state(body).position.x(); };
    for (int k = 0; k < 90 && place() < 1.5; ++k) manager.step(testing::kFrame);
    if (place() >= 1.5) sum += manager.state(body).velocity.norm() / speed / kStarts;
    manager.remove_body(body);
  }
  return sum;
}

// Each stopped at the first seam: the next cube's side, over which it was already, was met as a wall. At full
// .82 of the speed is left at friction .1.
TEST_P(Seams, OfBodiesInARowDoNotStopWhatSlides) {
  manager_.materials().replace(0, {.restitution = 0.3, .friction = 0.1});
  manager_.add_plane(Vec3::UnitZ(), 0.0);
  for (int k = 0; k < 10; ++k)
    for (int j = -1; j <= 1; ++j)
      testing::add(manager_, cube(), {.position = {kCube * k, kCube * j, 0.5 * kCube}}, GetParam());
  testing::run(manager_, 1.0);
  EXPECT_NEAR(slide_over_row(manager_, GetParam()), 0.82, 0.03);
}

// Its top is .3 m long, from x = -.15 on, and at z = .3; below it is hollow but for a wall.
std::shared_ptr<const Shape> make_bracket() {
  Mesh bracket;
  const std::vector<std::pair<double, double>> outline{{-0.15, 0.0}, {-0.05, 0.0}, {-0.05, 0.2},
                                                       {0.15, 0.2},  {0.15, 0.3},  {-0.15, 0.3}};
  const int count = int(outline.size());
  for (const double y : {-0.45, 0.45})
    for (const auto& [x, z] : outline) bracket.vertices.push_back({x, y, z});
  for (const auto& [a, b, c] : {std::array{0, 1, 2}, {0, 2, 5}, {2, 3, 4}, {2, 4, 5}}) {
    bracket.faces.push_back({a, b, c});
    bracket.faces.push_back({count + a, count + c, count + b});
  }
  for (int i = 0; i < count; ++i) {
    const int next = (i + 1) % count;
    bracket.faces.push_back({i, count + i, next});
    bracket.faces.push_back({next, count + i, count + next});
  }
  return std::make_shared<const Shape>(make_shape("bracket", bracket));
}

// Whose bodies meet in their convex pieces.
TEST_P(Seams, OfConcaveBodiesDoNotStopWhatSlides) {
  manager_.materials().replace(0, {.restitution = 0.3, .friction = 0.1});
  const auto bracket = make_bracket();
  for (int k = 0; k < 10; ++k)
    manager_.add_body({.shape = bracket,
                       .state = {.position = bracket->center_of_mass_in_mesh + Vec3(kCube * k, 0, 0)},
                       .level = GetParam(),
                       .properties = {.kinematic = true}});
  EXPECT_NEAR(slide_over_row(manager_, GetParam()), 0.82, 0.03);
}

TEST_P(Seams, OfKinematicBodiesDoNotStopWhatSlides) {
  manager_.materials().replace(0, {.restitution = 0.3, .friction = 0.1});
  for (int k = 0; k < 4; ++k)
    manager_.add_body({.shape = testing::box_shape({0.9, 2.0, 0.3}),
                       .state = {.position = {0.9 * k, 0, 0.15}},
                       .level = GetParam(),
                       .properties = {.kinematic = true}});
  EXPECT_NEAR(slide_over_row(manager_, GetParam()), 0.82, 0.03);
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
