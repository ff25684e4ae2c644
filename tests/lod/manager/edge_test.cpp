// Bodies that fall on edges of the ground, each on a block of its own.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "reference/random.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

constexpr int kRows = 14;
constexpr double kApart = 4.0, kSide = 0.8, kHeight = 0.5;  // m, of blocks

struct Fallen {
  double energy_1s = 0.0, energy = 0.0;  ///< J, mean of a body after one second, and at the end
  int on_top = 0, asleep = 0;
  double lowest = 1e9;  ///< m, of the centres at the end
};

Fallen drop_on_edges(const std::shared_ptr<const Shape>& shape, LevelChoice level) {
  ManagerSettings settings;
  settings.full_substeps = 8;
  settings.signatures = [](const Shape& of, const ContactLaw& law) {
    static std::map<double, std::shared_ptr<const Signature>> known;  // by volume
    auto& one = known[of.volume];
    if (!one) one = testing::coarse_signature(of, law);
    return one;
  };
  Manager manager = testing::on_floor(settings);
  std::vector<BodyId> bodies;
  for (int i = 0; i < kRows * kRows; ++i) {
    const Vec3 block(kApart * (i % kRows), kApart * (i / kRows), 0.5 * kHeight);
    manager.add_static_box({kSide, kSide, kHeight}, block, Quat::Identity());
    RandomStream random(8, std::uint64_t(i), 0);
    const Vec3 aside(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), 0.9);
    bodies.push_back(testing::add(manager, shape,
                                  {.position = block + aside,
                                   .orientation = random.orientation(),
                                   .angular_velocity = random.uniform(0, 4) * Vec3(0.6, 0.0, 0.8)},
                                  level));
  }
  const auto mean_energy = [&] {
    double sum = 0.0;
    for (const BodyId body : bodies)
      sum += testing::energy(manager, body) + 9.81 * manager.mass(body) * manager.state(body).position.z();
    return sum / double(bodies.size());
  };
  Fallen fallen;
  testing::run(manager, 1.0);
  fallen.energy_1s = mean_energy();
  testing::run(manager, 5.0);
  fallen.energy = mean_energy();
  for (const BodyId body : bodies) {
    const double height = manager.state(body).position.z();
    fallen.on_top += height > kHeight;
    fallen.lowest = std::min(fallen.lowest, height);
    fallen.asleep += manager.asleep(body);
  }
  return fallen;
}

// Spheres lay on them where hulls tip over: half as many more stayed on top.
TEST(Edge, BodiesAloneFallOffItAsOften) {
  for (const auto& shape : {std::make_shared<const Shape>(make_shape("crate", make_box({0.2, 0.3, 0.4}))),
                            std::make_shared<const Shape>(make_shape("L", make_l(0.3, 0.4, 0.1, 0.15)))}) {
    const Fallen full = drop_on_edges(shape, LevelChoice::full);
    for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables}) {
      const Fallen fallen = drop_on_edges(shape, level);
      SCOPED_TRACE(shape->name + (level == LevelChoice::support ? " at support" : " at tables"));
      EXPECT_NEAR(fallen.energy_1s / full.energy_1s, 1.0, 0.08);
      EXPECT_NEAR(fallen.energy / full.energy, 1.0, 0.1);
      EXPECT_NEAR(fallen.on_top, full.on_top, 16);
      EXPECT_EQ(fallen.asleep, kRows * kRows);
      EXPECT_GT(fallen.lowest, 0.07);
    }
  }
}

// Over a corner of a saddle each triangle has the body beyond an edge that does not stand out.
TEST(Edge, NothingFallsThroughTheCornersOfHills) {
  constexpr int kCells = 20;
  constexpr double kCell = 0.75, kWave = 0.15;  // m
  const auto height = [](double x, double y) { return kWave * std::sin(0.7 * x) * std::cos(0.6 * y); };
  Mesh hills;
  for (int i = 0; i <= kCells; ++i)
    for (int j = 0; j <= kCells; ++j) {
      const double x = kCell * (i - kCells / 2), y = kCell * (j - kCells / 2);
      hills.vertices.push_back({x, y, height(x, y)});
    }
  for (int i = 0; i < kCells; ++i)
    for (int j = 0; j < kCells; ++j) {
      const int a = i * (kCells + 1) + j, b = a + kCells + 1;
      hills.faces.push_back({a, b, b + 1}), hills.faces.push_back({a, b + 1, a + 1});
    }
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables}) {
    Manager manager({.signatures = testing::coarse_signature});
    manager.add_static_mesh(hills);
    std::vector<BodyId> cubes;
    for (int i = 2; i < kCells - 1; i += 2)
      for (int j = 2; j < kCells - 1; j += 2) {
        const double x = kCell * (i - kCells / 2), y = kCell * (j - kCells / 2);
        cubes.push_back(testing::add(manager, testing::box_shape({0.4, 0.4, 0.4}),
                                     testing::at({x, y, height(x, y) + 0.5}), level));
      }
    testing::run(manager, 3.0);
    for (const BodyId body : cubes) {
      const Vec3 at = manager.state(body).position;
      EXPECT_GT(at.z(), height(at.x(), at.y()) + 0.1) << int(level);
    }
  }
}

}  // namespace
}  // namespace lodestone
