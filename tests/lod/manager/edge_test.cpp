// Bodies that fall on edges of the ground, each on a block of its own.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "reference/random.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone::edge_test {
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

/// What slides off the end of a table, each on one of its own, once its centre is .4 m beyond.
struct SlidOff {
  double aside = 0.0;    ///< rad/s, mean: what of the spin is not tipping
  double tipping = 0.0;  ///< rad/s, mean
};

SlidOff slide_off_tables(LevelChoice level, double dt, int substeps) {
  ManagerSettings settings = testing::unmeasured();
  settings.full_substeps = substeps;
  Manager manager(settings);
  constexpr int kTables = 40;
  std::vector<BodyId> bodies;
  for (int i = 0; i < kTables; ++i) {
    RandomStream random(15, std::uint64_t(i), 0);
    manager.add_static_box({3, 2, 0.2}, {0, 3.0 * i, -0.1}, Quat::Identity());
    const Quat turned(Eigen::AngleAxisd(random.uniform(0, 3), Vec3::UnitZ()));
    bodies.push_back(testing::add(
        manager, testing::box_shape({0.2, 0.3, 0.4}),
        {.position = {0.8, 3.0 * i, 0.2001}, .orientation = turned, .velocity = {random.uniform(3, 5), 0, 0}},
        level));
  }
  SlidOff off;
  std::vector<bool> gone(kTables, false);
  for (double t = 0.0; t < 1.0; t += dt) {
    manager.step(dt);
    for (int i = 0; i < kTables; ++i) {
      const RigidState state = manager.state(bodies[std::size_t(i)]);
      if (gone[std::size_t(i)] || state.position.x() < 1.9) continue;
      gone[std::size_t(i)] = true;
      const Vec3& w = state.angular_velocity;
      off.aside += (std::abs(w.x()) + std::abs(w.z())) / kTables, off.tipping += w.y() / kTables;
    }
  }
  return off;
}

// A corner that leaves the table goes along the body's face, which the edge of the table is on: it strikes no
// plane that the table's top would be if it went on, and the body does not spin aside (as it did by .7
// rad/s).
TEST(Edge, ABoxThatSlidesOffATableTipsStraight) {
  const SlidOff truth = slide_off_tables(LevelChoice::full, 1.0 / 960, 1);
  for (const double dt : {1.0 / 60, 1.0 / 240, 1.0 / 960}) {
    const SlidOff off = slide_off_tables(LevelChoice::support, dt, 4);
    EXPECT_LT(off.aside, truth.aside + 0.1) << dt;
    EXPECT_NEAR(off.tipping, truth.tipping, 0.1 * truth.tipping) << dt;
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

/// A hollow (of radius 1 m about (0, 0, 1)) or a hill of triangles, `rings` of them; height: of a ring's
/// corners, m.
template <class Height>
Mesh round_mesh(int rings, double radius, const Height& height) {
  Mesh mesh;
  const int sectors = 3 * rings;
  mesh.vertices.push_back({0, 0, height(0.0)});
  for (int i = 1; i <= rings; ++i)
    for (int k = 0; k < sectors; ++k) {
      const double out = radius * i / rings, angle = 2.0 * std::numbers::pi * k / sectors;
      mesh.vertices.push_back({out * std::cos(angle), out * std::sin(angle), height(out)});
    }
  const auto corner = [&](int i, int k) { return i == 0 ? 0 : 1 + (i - 1) * sectors + k % sectors; };
  for (int k = 0; k < sectors; ++k) {
    mesh.faces.push_back({0, corner(1, k), corner(1, k + 1)});
    for (int i = 1; i < rings; ++i) {
      mesh.faces.push_back({corner(i, k), corner(i + 1, k), corner(i + 1, k + 1)});
      mesh.faces.push_back({corner(i, k), corner(i + 1, k + 1), corner(i, k + 1)});
    }
  }
  return mesh;
}

// Edges of a hollow, which no ball meets, stopped it: it lost two fifths of its energy in a second.
TEST(Edge, ABallRollsThroughAHollow) {
  constexpr double kBall = 0.1, kOut = 0.7;  // m
  const auto ball = std::make_shared<const Shape>(make_sphere_shape(kBall));
  const double start = 1.0 - std::sqrt((1.0 - kBall) * (1.0 - kBall) - kOut * kOut);
  for (const int rings : {16, 40}) {
    Manager manager({.signatures = testing::coarse_signature});
    manager.materials().replace(0, {.restitution = 0.0, .friction = 0.6});
    manager.add_static_mesh(
        round_mesh(rings, 0.95, [](double out) { return 1.0 - std::sqrt(1.0 - out * out); }));
    const BodyId body = testing::add(manager, ball, testing::at({kOut, 0, start}), LevelChoice::support);
    double highest = 0.0;  // on the other side
    for (int i = 0; i < 100; ++i) {
      manager.step(testing::kFrame);
      if (const Vec3 at = manager.state(body).position; at.x() < 0.0) highest = std::max(highest, at.z());
    }
    EXPECT_GT(highest - kBall, 0.85 * (start - kBall)) << rings;
    EXPECT_LT(highest - kBall, start - kBall) << rings;
  }
}

// Over its top a ball lies over none of the triangles.
TEST(Edge, ABallOnAGentleHillTopDoesNotFallThrough) {
  constexpr double kBall = 0.1;  // m
  const auto ball = std::make_shared<const Shape>(make_sphere_shape(kBall));
  for (const double slope : {0.03, 0.1, 0.3}) {
    const auto height = [slope](double out) { return 1.0 - slope * out; };
    const Mesh hill = round_mesh(8, 3.0, height);
    for (int i = 0; i < 9; ++i) {
      Manager manager({.signatures = testing::coarse_signature});
      manager.add_static_mesh(hill);
      const BodyId body = testing::add(manager, ball, testing::at({0.02 * (i - 4), 0.01 * (i % 3), 1.2}),
                                       LevelChoice::support);
      for (int frame = 0; frame < 90; ++frame) {
        manager.step(testing::kFrame);
        const Vec3 at = manager.state(body).position;
        ASSERT_GT(at.z(), height(at.head<2>().norm()) + 0.9 * kBall) << slope << " in frame " << frame;
      }
    }
  }
}

}  // namespace
}  // namespace lodestone::edge_test
