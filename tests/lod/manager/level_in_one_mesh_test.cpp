// Ground as games have it: a whole level in one mesh, of more parts than are met as convex pieces, thin and
// thick ones, let into each other. Each triangle is met by itself.
#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "reference/random.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

class LevelInOneMesh : public ::testing::TestWithParam<LevelChoice> {
 protected:
  LevelInOneMesh() {
    add({20, 20, 1}, {0, 0, -0.5});
    for (int i = 0; i < 20; ++i) add({0.3, 0.3, 0.3}, {-9.0 + 0.9 * i, 9, 0.14});
  }
  void add(const Vec3& sides, const Vec3& at, const Quat& turned = Quat::Identity()) {
    const Mesh box = make_box(sides);
    const int before = int(mesh_.vertices.size());
    for (const Vec3& v : box.vertices) mesh_.vertices.push_back(at + turned * v);
    for (const auto& f : box.faces) mesh_.faces.push_back({f[0] + before, f[1] + before, f[2] + before});
  }
  Manager make_manager() const {
    static const auto signature = testing::coarse_signature(*crate(), {});
    Manager manager({.signatures = [](const Shape&, const ContactLaw&) { return signature; }});
    manager.materials().replace(0, {.restitution = 0.3, .friction = 0.5});
    manager.add_static_mesh(mesh_);
    return manager;
  }
  static std::shared_ptr<const Shape> crate() {
    static const auto shape = std::make_shared<const Shape>(make_shape("crate", make_box({0.4, 0.4, 0.4})));
    return shape;
  }

  Mesh mesh_;
};

// The pedestal's sides were solid far inwards, and moved it by up to .4 m in a frame.
TEST_P(LevelInOneMesh, WhatOverhangsItsPedestalLies) {
  add({1.0, 1.0, 0.7}, {0, 0, 0.35});
  Manager manager = make_manager();
  for (const double along : {0.1, 0.2, 0.3, 0.4})
    for (const double yaw : {0.0, 0.35}) {
      const RigidState start{.position = {along, 0.1, 0.9005},
                             .orientation = Quat(Eigen::AngleAxisd(yaw, Vec3::UnitZ()))};
      const BodyId body = testing::add(manager, crate(), start, GetParam());
      testing::run(manager, 1.0);
      EXPECT_LT((manager.state(body).position - start.position).norm(), 0.005) << along << ' ' << yaw;
      manager.remove_body(body);
    }
}

// Of twelve crates 11 fell through, or stuck in it.
TEST_P(LevelInOneMesh, WhatFallsOnAThinTableStaysOnIt) {
  add({1.6, 1.6, 0.05}, {0, 0, 0.975});
  for (const double x : {-0.75, 0.75})
    for (const double y : {-0.75, 0.75}) add({0.08, 0.08, 0.99}, {x, y, 0.475});
  Manager manager = make_manager();
  for (int i = 0; i < 12; ++i) {
    RandomStream random(3, std::uint64_t(i), 0);
    const BodyId body = testing::add(manager, crate(),
                                     {.position = {random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), 1.5},
                                      .orientation = random.orientation()},
                                     GetParam());
    testing::run(manager, 4.0);
    EXPECT_NEAR(manager.state(body).position.z(), 1.2, 0.01) << i;
    EXPECT_TRUE(manager.asleep(body)) << i;
    manager.remove_body(body);
  }
}

// The mean of all layers lies below the upper one.
TEST_P(LevelInOneMesh, WhatLiesOnLayersLiesOnTheUpperOne) {
  for (const double z : {0.025, 0.075}) add({6, 6, 0.05}, {0, 0, z});
  Manager manager = make_manager();
  const BodyId body = testing::add(manager, crate(), {.position = {0.1, 0.2, 0.3005}}, GetParam());
  testing::run(manager, 2.0);
  EXPECT_NEAR(manager.state(body).position.z(), 0.3, 1e-3);
}

// Half of them ended behind one of 2 cm.
TEST_P(LevelInOneMesh, NobodyPassesAThinWall) {
  for (int i = 0; i < 4; ++i) add({0.02, 2.0, 2.5}, {-6.0 + 3.0 * i, 0, 1.24});
  Manager manager = make_manager();
  std::vector<std::pair<BodyId, double>> thrown;  // and where its wall stands, m
  for (int i = 0; i < 24; ++i) {
    RandomStream random(5, std::uint64_t(i), 0);
    const double wall = -6.0 + 3.0 * (i % 4), side = i % 2 == 0 ? 1.0 : -1.0;
    const BodyId body = testing::add(manager, crate(),
                                     {.position = {wall + 0.8 * side, random.uniform(-0.5, 0.5), 0.8},
                                      .orientation = random.orientation(),
                                      .velocity = {-side * random.uniform(1.0, 8.0), 0, 0}},
                                     GetParam());
    testing::run(manager, 2.0);
    const Vec3 place = manager.state(body).position;
    EXPECT_GT((place.x() - wall) * side, 0.15) << i;
    EXPECT_GT(place.z(), 0.19) << i;
    manager.remove_body(body);
  }
}

// All of a heap.
TEST_P(LevelInOneMesh, WhatIsPouredIntoATubLiesInIt) {
  add({1.6, 1.6, 0.04}, {0, 0, 0.5});
  for (const double side : {-0.78, 0.78}) {
    add({0.04, 1.6, 2.0}, {side, 0, 1.49});
    add({1.52, 0.04, 2.0}, {0, side, 1.49});
  }
  Manager manager = make_manager();
  std::vector<BodyId> bodies;
  for (int i = 0; i < 12; ++i) {
    RandomStream random(7, std::uint64_t(i), 0);
    bodies.push_back(testing::add(
        manager, crate(),
        {.position = {0.35 * (i % 2 ? 1 : -1), 0.35 * (i / 2 % 2 ? 1 : -1), 0.9 + 0.72 * (i / 4)},
         .orientation = random.orientation()},
        GetParam()));
  }
  testing::run(manager, 6.0);
  for (const BodyId body : bodies) {
    const Vec3 place = manager.state(body).position;
    EXPECT_LT(place.head<2>().cwiseAbs().maxCoeff(), 0.62);
    EXPECT_GT(place.z(), 0.66);
  }
}

INSTANTIATE_TEST_SUITE_P(Rungs, LevelInOneMesh, ::testing::Values(LevelChoice::support, LevelChoice::tables),
                         [](const auto& level) {
                           return level.param == LevelChoice::support ? "Support" : "Tables";
                         });

}  // namespace
}  // namespace lodestone
