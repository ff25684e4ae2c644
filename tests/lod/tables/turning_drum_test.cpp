// Bodies of `tables` in a drum that turns: none leaves it through its walls.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "reference/random.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

constexpr int kWalls = 8;
constexpr double kInner = 1.4, kThickness = 0.2, kLength = 2.2;  // m
constexpr double kTurning = 2.6;                                 // rad/s: at the rim 2.6 g

void append(Mesh& mesh, const Vec3& sides, const Vec3& place, const Quat& turned) {
  const auto first = int(mesh.vertices.size());
  const Mesh box = make_box(sides);
  for (const Vec3& v : box.vertices) mesh.vertices.push_back(place + turned * v);
  for (const auto& f : box.faces) mesh.faces.push_back({f[0] + first, f[1] + first, f[2] + first});
}

/// Eight slabs around the axis y and two ends, which overlap where they meet, as one builds such things.
Mesh make_drum() {
  Mesh drum;
  const double middle = kInner + 0.5 * kThickness, outer = 2.0 * (kInner + kThickness);
  for (int i = 0; i < kWalls; ++i) {
    const Quat turned(Eigen::AngleAxisd(2.0 * std::numbers::pi * i / kWalls, Vec3::UnitY()));
    append(drum, {1.3, kLength, kThickness}, turned * Vec3(0, 0, -middle), turned);
  }
  for (const double side : {-1.0, 1.0})
    append(drum, {outer, kThickness, outer}, {0, side * 0.5 * kLength, 0}, Quat::Identity());
  return drum;
}

// Who came near a wall that turns but met no plane of it was answered by the plane of another body; others
// pressed one through the wall; and the wall's outer face pushed out who was near a corner, where its slabs
// are thicker: of 60 drums 31 lost somebody, of these all.
TEST(TurningDrum, KeepsWhatIsInIt) {
  constexpr int kDrums = 4, kBodies = 16, kFrames = 480;
  const auto post = std::make_shared<const Shape>(make_shape("post", make_box({0.1, 0.1, 0.5})));
  for (std::uint32_t seed = 0; seed < kDrums; ++seed) {
    Manager manager({.signatures = coarse_signature});
    manager.materials().replace(0, {.restitution = 0.7, .friction = 0.2});
    const GroundId drum = manager.add_static_mesh(make_drum());
    RandomStream random(seed, 3, 0);
    std::vector<BodyId> bodies;
    for (int i = 0; i < kBodies; ++i)
      bodies.push_back(add(manager, post,
                           {.position = Vec3(0.6 * (i % 3 - 1), 0.6 * (i / 3 % 3 - 1), 0.6 * (i / 9) - 0.8),
                            .orientation = random.orientation()},
                           LevelChoice::tables));
    double farthest = 0.0;
    for (int frame = 0; frame < kFrames; ++frame) {
      const Quat turned(Eigen::AngleAxisd(kTurning * frame * kFrame, Vec3::UnitY()));
      manager.move_ground(drum, {.orientation = turned, .angular_velocity = {0, kTurning, 0}});
      manager.step(kFrame);
      for (const BodyId body : bodies) {
        const Vec3 place = manager.state(body).position;
        farthest = std::max({farthest, std::hypot(place.x(), place.z()) * std::cos(std::numbers::pi / kWalls),
                             std::abs(place.y()) + kInner - 0.5 * kLength});
      }
    }
    EXPECT_LT(farthest, kInner + 0.5 * kThickness) << seed;
  }
}

}  // namespace
}  // namespace lodestone
