#include "signature/settling_clips.h"

#include <gtest/gtest.h>

namespace lodestone {
namespace {

TEST(SettlingClips, FramesSurviveSixteenBits) {
  const ClipState state{{1.5, -2.0, 0.7}, Quat(0.5, 0.5, -0.5, 0.5), {0.3, -0.4, 0.1}, {1.0, 2.0, -3.0}};
  const ClipState back = decode_frame(encode_frame(state, 4.0f), 4.0f);
  EXPECT_LT((back.position - state.position).norm(), 3e-4);
  EXPECT_LT(back.orientation.angularDistance(state.orientation), 1e-4);
  EXPECT_LT((back.velocity - state.velocity).norm(), 3e-4);
  EXPECT_LT((back.angular_velocity - state.angular_velocity).norm(), 3e-4);
}

TEST(SettlingClips, PosesAreSmoothAndImpactsSudden) {
  Signature signature;
  signature.clips = {{.first_frame = 0, .frames = 3, .extent = 1.0f}};
  const double heights[] = {1.0, 0.8, 0.9}, speeds[] = {-1.0, 0.5, 0.4};
  for (int i = 0; i < 3; ++i)
    signature.clip_frames.push_back(
        encode_frame({{0, 0, heights[i]}, Quat::Identity(), {0, 0, speeds[i]}, Vec3::Zero()}, 1.0f));
  const auto at = [&](double frame) { return find_clip_state(signature, signature.clips[0], frame); };
  EXPECT_NEAR(at(0.5).position.z(), 0.9, 1e-3);
  EXPECT_NEAR(at(0.9).velocity.z(), -1.0, 1e-3);
  EXPECT_NEAR(at(1.0).velocity.z(), 0.5, 1e-3);
  EXPECT_NEAR(at(99.0).position.z(), 0.9, 1e-3);
  EXPECT_NEAR(at(-1.0).position.z(), 1.0, 1e-3);
}

}  // namespace
}  // namespace lodestone
