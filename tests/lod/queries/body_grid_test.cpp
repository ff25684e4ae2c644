// The grid of all bodies, against a look at every body.
#include "lod/queries/body_grid.h"

#include <gtest/gtest.h>

#include <set>

#include "lod/queries/triangle_tree.h"
#include "reference/random.h"

namespace lodestone {
namespace {

struct Ball {
  Vec3 position;
  double radius = 0.0;
};

class BodyGridTest : public ::testing::Test {
 protected:
  Vec3 somewhere(double reach) {
    return {random.uniform(-reach, reach), random.uniform(-reach, reach), random.uniform(-reach, reach)};
  }
  void put(std::uint32_t body, const Ball& ball) {
    if (balls.size() <= body) balls.resize(body + 1);
    balls[body] = ball;
    grid.put(body, ball.position, ball.radius);
  }
  RandomStream random{7, 0, 0};
  std::vector<Ball> balls;
  BodyGrid grid;
};

// Of all sizes, some of which come and go and move between the questions.
TEST_F(BodyGridTest, FindsAllThatBoxesAndRaysMeet) {
  for (std::uint32_t body = 0; body < 1000; ++body)
    put(body, {somewhere(8.0), 0.1 * std::pow(30.0, random.uniform())});
  std::size_t met = 0;
  for (int round = 0; round < 200; ++round) {
    for (int k = 0; k < 50; ++k) {
      const auto body = std::uint32_t(random.uniform() * double(balls.size()));
      const double what = random.uniform();
      if (what < 0.2) {
        grid.forget(body);
        balls[body].radius = 0.0;
      } else if (balls[body].radius == 0.0) {
        put(body, {somewhere(8.0), 0.3});
      } else {
        put(body, {balls[body].position + somewhere(what < 0.9 ? 0.05 : 5.0), balls[body].radius});
      }
    }
    const Vec3 from = somewhere(10.0), direction = random.direction(), half = somewhere(3.0).cwiseAbs();
    const double length = round % 10 ? random.uniform(0.0, 40.0) : 1e300,
                 margin = round % 3 ? 0.0 : random.uniform(0.0, 2.0);
    std::set<std::uint32_t> along, near;
    grid.find_along(from, direction, length, margin,
                    [&](std::uint32_t body) { return along.insert(body), length; });
    const Eigen::AlignedBox3d box(from - half, from + half);
    grid.find_near(box, [&](std::uint32_t body) { near.insert(body); });
    for (std::uint32_t body = 0; body < balls.size(); ++body) {
      const Ball& ball = balls[body];
      if (ball.radius == 0.0) {
        EXPECT_FALSE(along.contains(body) || near.contains(body));
        continue;
      }
      const bool is_along =
                     meet_sphere(from, direction, length, ball.position, ball.radius + margin).has_value(),
                 is_near = box.exteriorDistance(ball.position) < ball.radius;
      EXPECT_TRUE(!is_along || along.contains(body));
      EXPECT_TRUE(!is_near || near.contains(body));
      met += std::size_t(is_along) + std::size_t(is_near);
    }
  }
  EXPECT_GT(met, 1000u);
  std::size_t there = 0;
  for (const Ball& ball : balls) there += ball.radius > 0.0;
  EXPECT_EQ(grid.size(), there);
}

// A ray ends where what it met says so.
TEST_F(BodyGridTest, RayStopsWhereItIsTold) {
  for (std::uint32_t body = 0; body < 1000; ++body) put(body, {Vec3(double(body), 0, 0), 0.2});
  int asked = 0;
  grid.find_along({-1, 0, 0}, {1, 0, 0}, 1e4, 0.0,
                  [&](std::uint32_t body) { return ++asked, body == 5 ? 6.0 : 1e4; });
  EXPECT_LE(asked, 20);
}

}  // namespace
}  // namespace lodestone
