// What spins fast meets nothing out of the reach of its corners, however far along their tangents they would
// go in a step.
#include <gtest/gtest.h>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone::spinning_test {
namespace {

using namespace lodestone::testing;

constexpr double kSide = 0.2, kClear = 0.05;  // m

std::shared_ptr<const Shape> make_cube() {
  return std::make_shared<const Shape>(make_shape("cube", make_box({kSide, kSide, kSide})));
}

// m/s, in a second.
double fastest(Manager& manager, BodyId body) {
  double speed = 0.0;
  for (int i = 0; i < 60; ++i) {
    manager.step(kFrame);
    speed = std::max(speed, manager.state(body).velocity.norm());
  }
  return speed;
}

// It was thrown off at 70 m/s.
TEST(Spinning, InTheAirBesideABoxOrAMeshACubeStays) {
  const auto cube = make_cube();
  const double wall = cube->radius + kClear;
  for (const bool of_triangles : {false, true})
    for (const double spin : {100.0, 300.0, 1000.0}) {  // rad/s
      ManagerSettings settings = unmeasured();
      settings.gravity.setZero();
      Manager manager(settings);
      if (of_triangles) {
        Mesh mesh = make_box({1, 1, 1});
        for (Vec3& vertex : mesh.vertices) vertex.x() += wall + 0.5;
        manager.add_static_mesh(mesh);
      } else {
        manager.add_static_box({1, 1, 1}, {wall + 0.5, 0, 0}, Quat::Identity());
      }
      const BodyId body =
          add(manager, cube, {.angular_velocity = {0, 0.3 * spin, spin}}, LevelChoice::support);
      EXPECT_LT(fastest(manager, body), 1e-9) << of_triangles << ' ' << spin;
    }
}

// On the floor, at 14 and 48 m/s.
TEST(Spinning, OnTheFloorBesideAWallACubeStays) {
  const auto cube = make_cube();
  for (const double spin : {100.0, 300.0, 1000.0}) {  // rad/s
    Manager manager = on_floor();
    manager.add_plane({-1, 0, 0}, -cube->radius - kClear);
    const BodyId body =
        add(manager, cube, {.position = {0, 0, 0.5 * kSide}, .angular_velocity = {0, 0, spin}},
            LevelChoice::support);
    EXPECT_LT(fastest(manager, body), 0.05) << spin;
  }
}

}  // namespace
}  // namespace lodestone::spinning_test
