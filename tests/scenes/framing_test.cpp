#include "scenes/framing.h"

#include <gtest/gtest.h>

#include <limits>

#include "reference/random.h"
#include "scenes/camera.h"

namespace lodestone {
namespace {

Scene balls(int count) {
  Scene scene;
  scene.bodies.resize(std::size_t(count));
  const auto ball = std::make_shared<const Shape>(make_sphere_shape(0.1));
  for (SceneBody& body : scene.bodies) body.definition.shape = ball;
  return scene;
}

// A cloud that falls: in the picture from the first frame to the last, wherever it is and however large.
TEST(Framing, NearlyAllBodiesAreInThePicture) {
  for (const double size : {0.5, 50.0})
    for (const Vec3& middle : {Vec3(0, 0, 0), Vec3(100, -30, 7)}) {
      constexpr int kBodies = 300, kFrames = 20;
      RandomStream random(5, 0, 0);
      Trajectory trajectory(kBodies);
      std::vector<RigidState> states(kBodies);
      for (RigidState& state : states) state.position = middle + size * random.uniform() * random.direction();
      states[0].position = middle + Vec3(1000 * size, 0, 0);  // a stray
      const std::vector<BodyStatus> statuses(kBodies);
      for (int frame = 0; frame < kFrames; ++frame) {
        trajectory.add_frame(frame / 30.0, states, statuses);
        for (RigidState& state : states) state.position.z() -= size / kFrames;
      }
      const SceneViewpoint viewpoint = frame_bodies(trajectory, balls(kBodies));
      const Camera camera(viewpoint.position_m, viewpoint.look_at_m);
      for (const int frame : {0, kFrames - 1}) {
        int seen = 0;
        for (int body = 0; body < kBodies; ++body) {
          const auto& [x, y, z] = trajectory.position(frame, body);
          seen += camera.sees(Vec3(x, y, z));
        }
        EXPECT_GE(seen, int(0.97 * kBodies)) << size << ", " << middle.transpose();
      }
      EXPECT_GT(viewpoint.position_m.z(), viewpoint.look_at_m.z());  // from above
      EXPECT_LT((viewpoint.position_m - viewpoint.look_at_m).norm(), 10 * size);
    }
}

TEST(Framing, OneBodyFillsThePictureAsFarAsItsSizeAllows) {
  Trajectory trajectory(1);
  const std::vector<RigidState> states(1);
  trajectory.add_frame(0.0, states, std::vector<BodyStatus>(1));
  const SceneViewpoint viewpoint = frame_bodies(trajectory, balls(1));
  EXPECT_LT(viewpoint.look_at_m.norm(), 1e-6);
  EXPECT_NEAR(viewpoint.position_m.norm(), 0.1 / std::sin(0.5 * kFieldOfView),
              1e-6);  // the ball touches its edges
}

TEST(Framing, WithoutAnythingToSeeThereIsACameraToo) {
  Trajectory none(1);
  std::vector<RigidState> states(1);
  states[0].position.x() = std::numeric_limits<double>::quiet_NaN();
  none.add_frame(0.0, states, std::vector<BodyStatus>(1));
  const SceneViewpoint viewpoint = frame_bodies(none, balls(1));
  EXPECT_TRUE(viewpoint.position_m.allFinite());
  EXPECT_GT(viewpoint.position_m.norm(), 1.0);
}

}  // namespace
}  // namespace lodestone
