#include "lod/ground/ground.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "lod/manager.h"
#include "reference/random.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

Manager over_a_table(StatisticalModel model = StatisticalModel::support) {
  ManagerSettings settings;
  settings.model = model;
  settings.signatures = [model](const Shape&, const ContactLaw&) {
    return model == StatisticalModel::tables ? std::make_shared<const Signature>() : nullptr;
  };
  Manager manager(settings);
  manager.add_plane(Vec3::UnitZ(), 0.0);
  return manager;
}

std::shared_ptr<const Shape> crate() {
  static const auto shape = std::make_shared<const Shape>(make_shape("crate", make_box({0.2, 0.2, 0.2})));
  return shape;
}

BodyId add_crate(Manager& manager, const Vec3& position, LevelChoice level = LevelChoice::statistical) {
  RigidState state;
  state.position = position;
  return manager.add_body({.shape = crate(), .state = state, .level = level});
}

void run(Manager& manager, double seconds) {
  for (int i = 0; i < int(seconds * 60.0); ++i) manager.step(1.0 / 60.0);
}

// A height field of n × n cells of .15 m, each of two triangles.
Mesh terrain(int n, const std::function<double(double, double)>& height) {
  Mesh mesh;
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x) {
      const double px = 0.15 * (x - n / 2), py = 0.15 * (y - n / 2);
      mesh.vertices.emplace_back(px, py, height(px, py));
    }
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const int a = y * (n + 1) + x, b = a + 1, c = a + n + 1, d = c + 1;
      mesh.faces.push_back({a, b, d});
      mesh.faces.push_back({a, d, c});
    }
  return mesh;
}

// As parts come, move and go: those near a ray are those whose boxes it comes near.
TEST(Ground, PartsAlongARayAreFoundWhereTheyAre) {
  Ground ground;
  RandomStream random(12, 0, 0);
  std::vector<GroundId> there;
  std::size_t met = 0;
  for (int i = 0; i < 400; ++i) {
    const Vec3 place = random.uniform(0, 20) * random.direction();
    const auto any = std::size_t(random.uniform() * double(there.size()));
    if (there.empty() || random.uniform() < 0.5) {
      there.push_back(ground.add_box({1, 2, 3}, place, random.orientation(), 0));
    } else if (random.uniform() < 0.5) {
      ground.move_part(there[any], {place, random.orientation()});
    } else {
      ground.remove(there[any]);
      there.erase(there.begin() + std::ptrdiff_t(any));
    }
    const Vec3 from = 25.0 * random.direction(),
               along = (10.0 * random.uniform() * random.direction() - from).normalized();
    std::vector<const GroundPart*> found;
    ground.find_parts_along(from, along, 30.0, 0.5, found);
    std::size_t expected = 0;
    for (const GroundId id : there) expected += enters_box(ground.bounds(id), 0.5, from, along, 30.0);
    ASSERT_EQ(found.size(), expected);
    for (const GroundPart* part : found)
      ASSERT_TRUE(enters_box(ground.bounds(part->id), 0.5, from, along, 30.0));
    met += found.size();
  }
  EXPECT_GT(met, 400u);
}

// A ball has no pose to rest in, and hops by what gravity adds in a step.
TEST(Ground, BallsAtTablesDoNotSink) {
  ManagerSettings settings;
  settings.signatures = testing::coarse_signature;
  Manager manager(settings);
  manager.add_plane(Vec3::UnitZ(), 0.0);
  manager.add_static_box({2, 2, 0.1}, {0, 0, 1}, Quat::Identity());
  const auto ball = std::make_shared<const Shape>(make_sphere_shape(0.18));
  const auto add_ball = [&](const Vec3& position) {
    RigidState state;
    state.position = position;
    return manager.add_body({.shape = ball, .state = state, .level = LevelChoice::tables});
  };
  const BodyId on_plane = add_ball({5, 0, 0.5}), on_box = add_ball({0, 0, 1.5});
  run(manager, 15.0);
  EXPECT_NEAR(manager.state(on_plane).position.z(), 0.18, 0.005);
  EXPECT_NEAR(manager.state(on_box).position.z(), 1.23, 0.005);
}

TEST(Ground, SupportRestsOnABoxAndSleeps) {
  Manager manager = over_a_table();
  manager.add_static_box({2, 2, 0.1}, {0, 0, 1}, Quat::Identity());
  const BodyId above = add_crate(manager, {0, 0, 2}), beside = add_crate(manager, {4, 0, 2});
  run(manager, 4.0);
  EXPECT_NEAR(manager.state(above).position.z(), 1.15, 0.003);
  EXPECT_NEAR(manager.state(beside).position.z(), 0.1, 0.003);
  EXPECT_EQ(manager.report().asleep, 2);
  EXPECT_EQ(manager.report().counters.ode_bodies_created, 0);
}

TEST(Ground, SupportStaysInATiltedCorner) {
  Manager manager = over_a_table();
  const Quat tilt = rotation_from_vector({0.3, 0.2, 0.0});
  manager.add_static_box({2, 2, 0.2}, tilt * Vec3(0, 0, -0.1) + Vec3(0, 0, 1), tilt);
  manager.add_static_box({0.2, 2, 1}, tilt * Vec3(1.0, 0, 0.5) + Vec3(0, 0, 1),
                         tilt);  // down the slope: +x, −y
  manager.add_static_box({2, 0.2, 1}, tilt * Vec3(0, -1.0, 0.5) + Vec3(0, 0, 1), tilt);
  std::vector<BodyId> crates;
  for (int i = 0; i < 5; ++i) crates.push_back(add_crate(manager, {0.5, -0.5, 1.6 + 0.3 * i}));
  run(manager, 6.0);
  for (const BodyId body : crates) {
    const Vec3 in_corner = tilt.conjugate() * (manager.state(body).position - Vec3(0, 0, 1));
    EXPECT_GT(in_corner.z(), 0.09);
    EXPECT_LT(in_corner.x(), 0.815);
    EXPECT_GT(in_corner.y(), -0.815);
    EXPECT_LT(manager.state(body).velocity.norm(), 0.05);
  }
}

TEST(Ground, SupportComesToRestOnStairs) {
  Manager manager = over_a_table();
  Mesh stairs = make_l(1.0, 1.0, 0.5, 2.0);  // two steps of .5 m, extruded along z: stood up
  for (Vec3& v : stairs.vertices) v = Vec3(v.x(), v.z(), v.y() + 0.5);
  for (auto& f : stairs.faces) std::swap(f[1], f[2]);
  manager.add_static_mesh(stairs);
  const BodyId high = add_crate(manager, {-0.25, 0, 2}), low = add_crate(manager, {0.25, 0, 2});
  run(manager, 4.0);
  EXPECT_NEAR(manager.state(high).position.z(), 1.1, 0.01);
  EXPECT_NEAR(manager.state(low).position.z(), 0.6, 0.01);
}

TEST(Ground, SupportSlidesOverTheSeamsOfAFlatMesh) {
  Manager flat = over_a_table(), meshed = over_a_table();
  meshed.add_static_mesh(terrain(40, [](double, double) { return 0.0; }));
  std::array<double, 2> distance{};
  for (Manager* manager : {&flat, &meshed}) {
    RigidState state;
    state.position = {-1.5, 0.03, 0.1};
    state.velocity = {3.0, 0.4, 0.0};
    const BodyId body =
        manager->add_body({.shape = crate(), .state = state, .level = LevelChoice::statistical});
    run(*manager, 3.0);
    distance[manager == &meshed] = (manager->state(body).position - state.position).norm();
    EXPECT_NEAR(manager->state(body).position.z(), 0.1, 0.003);
  }
  EXPECT_NEAR(distance[1], distance[0], 0.15 * distance[0]);
}

TEST(Ground, SupportRollsIntoTheValleyOfATerrain) {
  Manager manager = over_a_table();
  manager.add_static_mesh(terrain(40, [](double x, double y) { return 1.0 + 0.25 * (x * x + y * y); }));
  const auto ball = std::make_shared<const Shape>(make_sphere_shape(0.1));
  std::vector<BodyId> bodies;
  for (int i = 0; i < 6; ++i)
    bodies.push_back(manager.add_body({.shape = i % 2 ? ball : crate(),
                                       .state = {.position = Vec3(1.5 * std::cos(i), 1.5 * std::sin(i), 2.0)},
                                       .level = LevelChoice::statistical}));
  run(manager, 5.0);
  for (const BodyId body : bodies) {
    const Vec3& p = manager.state(body).position;
    EXPECT_GT(p.z(), 1.0 + 0.25 * p.head<2>().squaredNorm() + 0.08) << p.transpose();
    EXPECT_LT(p.z(), 1.0 + 0.25 * p.head<2>().squaredNorm() + 0.6);
  }
}

}  // namespace
}  // namespace lodestone
