#include "signature/settling_clips.h"

#include <gtest/gtest.h>

namespace lodestone {
namespace {

TEST(SettlingClips, PosesSurviveSixteenBits) {
  const ClipPose pose{{1.5, -2.0, 0.7}, Quat(0.5, 0.5, -0.5, 0.5)};
  const ClipPose back = decode_frame(encode_frame(pose, 4.0f), 4.0f);
  EXPECT_LT((back.position - pose.position).norm(), 3e-4);
  EXPECT_LT(back.orientation.angularDistance(pose.orientation), 1e-4);
}

TEST(SettlingClips, VelocitiesAreThoseOfTheMotionShown) {
  const Vec3 velocity(0.3, -0.4, -0.1), spin(0.2, 0.5, -1.0);
  Signature signature;
  signature.clip_frame_interval = 0.2f;
  signature.clips = {{0, 4, 1.0f}};
  for (int i = 0; i < 4; ++i) {
    const double time = 0.2 * i;
    signature.clip_frames.push_back(encode_frame({time * velocity + Vec3(0, 0, 1), rotation_from_vector(time * spin)}, 1.0f));
  }
  for (const double frame : {0.0, 0.4, 1.0, 2.7, 3.0, 9.0}) {
    const ClipState state = find_clip_state(signature, signature.clips[0], frame);
    EXPECT_LT((state.velocity - velocity).norm(), 2e-3) << frame;
    EXPECT_LT((state.angular_velocity - spin).norm(), 2e-3) << frame;
    EXPECT_LT((state.position - Vec3(0, 0, 1) - 0.2 * std::min(frame, 3.0) * velocity).norm(), 1e-3) << frame;
  }
}

}  // namespace
}  // namespace lodestone
