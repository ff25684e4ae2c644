// What falls between two walls that lean against each other comes to rest there.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

constexpr double kGravity = 9.81;                                                    // m/s²
constexpr double kWideTop = 0.2, kWideBottom = 0.1, kSlotDepth = 1.0, kCrate = 0.3;  // m, half of the widths

void add_slot_of_triangles(Manager& manager) {
  constexpr int kAlong = 41;  // rows, .1 m apart
  const double x[] = {-3.0, -kWideTop, -kWideBottom, kWideBottom, kWideTop, 3.0},
               z[] = {0.0, 0.0, -kSlotDepth, -kSlotDepth, 0.0, 0.0};
  Mesh mesh;
  for (int row = 0; row < kAlong; ++row)
    for (int i = 0; i < 6; ++i) mesh.vertices.push_back({x[i], 0.1 * row - 2.0, z[i]});
  for (int row = 0; row + 1 < kAlong; ++row)
    for (int i = 0; i < 5; ++i) {
      const int a = 6 * row + i, b = a + 1, c = a + 6, d = a + 7;
      mesh.faces.push_back({a, b, c}), mesh.faces.push_back({b, d, c});
    }
  manager.add_static_mesh(mesh);
}

void add_slot_of_boxes(Manager& manager) {
  const double lean = std::atan2(kWideTop - kWideBottom, kSlotDepth);
  for (const double side : {-1.0, 1.0}) {
    const Vec3 outward(side * std::cos(lean), 0.0, -std::sin(lean)),
        middle(side * 0.5 * (kWideTop + kWideBottom), 0.0, -0.5 * kSlotDepth);
    manager.add_static_box({2.0, 4.0, 1.2 * kSlotDepth}, middle + outward,
                           Quat(Eigen::AngleAxisd(side * lean, Vec3::UnitY())));
  }
}

void add_slot_of_planes(Manager& manager) {
  const double lean = std::atan2(kWideTop - kWideBottom, kSlotDepth);
  for (const double side : {-1.0, 1.0}) {
    const Vec3 inward(-side * std::cos(lean), 0.0, std::sin(lean));
    manager.add_plane(inward, inward.x() * side * kWideTop);
  }
}

// m, negative where a corner is in a wall.
double least_gap_in_slot(const RigidState& s) {
  double least = 1.0;
  for (const Vec3& corner : make_box({kCrate, kCrate, kCrate}).vertices) {
    const Vec3 at = s.position + s.orientation * corner;
    if (at.z() > 0.0) continue;  // over the slot
    least = std::min(least, kWideTop + (kWideTop - kWideBottom) / kSlotDepth * at.z() - std::abs(at.x()));
  }
  return least;
}

// As planes they pushed it from one into the other, and each triangle of a wall pushed it anew.
TEST(Wedge, CratesSleepBetweenWallsThatLeanAgainstEachOther) {
  for (const auto add_slot : {add_slot_of_boxes, add_slot_of_triangles, add_slot_of_planes})
    for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables}) {
      Manager manager({.signatures = coarse_signature});
      const char* name = add_slot == add_slot_of_boxes    ? "boxes"
                         : add_slot == add_slot_of_planes ? "planes"
                                                          : "triangles";
      add_slot(manager);
      std::vector<BodyId> crates;
      for (const Vec3& start :
           {Vec3(-0.0129, -0.0827, 0.5), Vec3(0.0401, 0.9525, 0.5), Vec3(0.031, -0.9655, 0.5)})
        crates.push_back(add(manager, box_shape({kCrate, kCrate, kCrate}), testing::at(start), level));
      run(manager, 1.0);
      double gained = 0.0;  // in a step at most, over what it takes to lift a crate by its side
      std::vector<double> before;
      for (const BodyId crate : crates) before.push_back(energy(manager, crate));
      for (int i = 0; i < 240; ++i) {
        manager.step(kFrame);
        for (std::size_t k = 0; k < crates.size(); ++k) {
          const double now = energy(manager, crates[k]);
          gained = std::max(gained, (now - before[k]) / (manager.mass(crates[k]) * kGravity * kCrate));
          before[k] = now;
        }
      }
      EXPECT_LT(gained, 1e-3) << name << ' ' << int(level);
      for (const BodyId crate : crates) {
        EXPECT_TRUE(manager.asleep(crate)) << name << ' ' << int(level);
        EXPECT_GT(least_gap_in_slot(manager.state(crate)), -0.01 * kCrate) << name << ' ' << int(level);
      }
    }
}

}  // namespace
}  // namespace lodestone
