#include "signature/signature_file.h"

#include <gtest/gtest.h>

#include "reference/error.h"
#include "reference/shape.h"
#include "signature/measure/measure.h"
#include "signature/settling_clips.h"

namespace lodestone {
namespace {

SignatureSettings quick_settings() {
  SignatureSettings settings;
  settings.n_theta = 3, settings.n_phi = 3, settings.n_alpha = 4, settings.trials_per_cell = 8;
  settings.held_out_conditions = 8, settings.height_trials = 50, settings.settling_trials = 24, settings.clips = 8;
  return settings;
}

const Signature& box_signature() {
  static const Signature signature = measure_signature(make_shape("box", make_box({0.2, 0.3, 0.4})), quick_settings(), 2);
  return signature;
}

TEST(SignatureFile, RoundTripKeepsEveryByte) {
  const std::vector<std::byte> bytes = encode_signature(box_signature());
  EXPECT_EQ(encode_signature(decode_signature(bytes, "test")), bytes);
}

TEST(SignatureFile, EveryTruncationIsAnError) {
  const std::vector<std::byte> bytes = encode_signature(box_signature());
  for (std::size_t length = 0; length < bytes.size(); length += 1 + length / 64)
    EXPECT_THROW(decode_signature(std::span(bytes).first(length), "test"), InputError) << "at " << length;
}

TEST(SignatureFile, EveryFlippedBitIsAnError) {
  std::vector<std::byte> bytes = encode_signature(box_signature());
  for (std::size_t i = 0; i < bytes.size(); i += 1 + i / 64) {
    bytes[i] ^= std::byte{0x10};
    EXPECT_THROW(decode_signature(bytes, "test"), InputError) << "at " << i;
    bytes[i] ^= std::byte{0x10};
  }
}

TEST(SignatureFile, TrailingBytesAreAnError) {
  std::vector<std::byte> bytes = encode_signature(box_signature());
  bytes.push_back(std::byte{0});
  EXPECT_THROW(decode_signature(bytes, "test"), InputError);
}

TEST(SettlingClips, FramesSurviveSixteenBits) {
  const ClipState state{{1.5, -2.0, 0.7}, Quat(0.5, 0.5, -0.5, 0.5), {0.3, -0.4, 0.1}, {1.0, 2.0, -3.0}};
  const ClipState back = decode_frame(encode_frame(state, 4.0f), 4.0f);
  EXPECT_LT((back.position - state.position).norm(), 3e-4);
  EXPECT_LT(back.orientation.angularDistance(state.orientation), 1e-4);
  EXPECT_LT((back.velocity - state.velocity).norm(), 3e-4);
  EXPECT_LT((back.angular_velocity - state.angular_velocity).norm(), 3e-4);
}

}  // namespace
}  // namespace lodestone
