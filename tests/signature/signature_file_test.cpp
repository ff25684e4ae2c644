#include "signature/signature_file.h"

#include <gtest/gtest.h>

#include "reference/error.h"
#include "reference/shape.h"
#include "signature/measure.h"
#include "signature/response_table.h"
#include "signature/settling_clips.h"

namespace lodestone {
namespace {

SignatureSettings quick_settings() {
  SignatureSettings settings;
  settings.n_theta = 3, settings.n_phi = 3, settings.n_alpha = 4, settings.trials_per_cell = 8;
  settings.height_trials = 50, settings.settling_trials = 24, settings.clips = 8;
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

TEST(Measure, TheSameForEveryThreadCountAndScale) {
  Signature one = measure_signature(make_shape("box", make_box({0.2, 0.3, 0.4})), quick_settings(), 1);
  Signature larger = measure_signature(make_shape("box", make_box({2.0, 3.0, 4.0})), quick_settings(), 2);
  one.measuring_seconds = larger.measuring_seconds = 0.0;
  Signature two = box_signature();
  two.measuring_seconds = 0.0;
  EXPECT_EQ(encode_signature(one), encode_signature(two));
  for (int cell = 0; cell < one.bouncing.cells(); ++cell)  // scaled copies differ by rounding only
    EXPECT_LT((one.bouncing.mean[cell] - larger.bouncing.mean[cell]).norm(), 0.05) << cell;
}

TEST(Measure, SphereHasOneHeightAndNoSpread) {
  const Signature sphere = measure_signature(make_sphere_shape(0.1), quick_settings(), 2);
  for (std::size_t i = 0; i < sphere.collision_heights.mean.size(); ++i) {
    EXPECT_NEAR(sphere.collision_heights.mean[i], 1.0, 1e-5);
    EXPECT_LT(sphere.collision_heights.deviation[i], 1e-3);
  }
  // Without spin, (V_rigid − V_particle) is friction alone: the normal component is exact, and there is no spread.
  for (int cell = 0; cell < sphere.bouncing.cells(); ++cell) EXPECT_NEAR(sphere.bouncing.mean[cell][0], 0.0, 1e-4);
  const ResponseStatistics slow_spin = find_response(sphere.bouncing, 0.8, 0.5, 0.0, false);
  EXPECT_LT(slow_spin.deviation.head<3>().maxCoeff(), 0.2f);
}

TEST(Measure, CollisionHeightGrowsWithSpin) {
  const CollisionHeights& heights = box_signature().collision_heights;
  EXPECT_GT(heights.mean.back(), heights.mean.front());
  for (const float h : heights.mean) {
    EXPECT_GT(h, 0.1 / std::sqrt(0.01 + 0.0225 + 0.04) - 1e-3);  // the shortest half side over R
    EXPECT_LE(h, 1.0f + 1e-5f);
  }
}

TEST(SettlingClips, FramesSurviveSixteenBits) {
  const ClipState state{{1.5, -2.0, 0.7}, Quat(0.5, 0.5, -0.5, 0.5), {0.3, -0.4, 0.1}, {1.0, 2.0, -3.0}};
  const ClipState back = decode_frame(encode_frame(state, 4.0f), 4.0f);
  EXPECT_LT((back.position - state.position).norm(), 3e-4);
  EXPECT_LT(back.orientation.angularDistance(state.orientation), 1e-4);
  EXPECT_LT((back.velocity - state.velocity).norm(), 3e-4);
  EXPECT_LT((back.angular_velocity - state.angular_velocity).norm(), 3e-4);
}

TEST(ResponseTable, LooksUpCellCentresExactlyAndFlagsWhatLiesOutside) {
  const ResponseTable& table = box_signature().bouncing;
  const int cell = (1 * table.n_phi + 2) * table.n_alpha + 3;
  const double theta = cell_center(1, table.n_theta, std::numbers::pi / 2), phi = cell_center(2, table.n_phi, std::numbers::pi),
               alpha = cell_center(3, table.n_alpha, std::numbers::pi / 2);
  for (const bool interpolate : {true, false}) {
    const ResponseStatistics found = find_response(table, theta, phi, alpha, interpolate);
    EXPECT_LT((found.mean - table.mean[cell]).norm(), 1e-5);
    EXPECT_FALSE(found.extrapolated);
  }
  EXPECT_TRUE(find_response(table, 1.6, phi, alpha).extrapolated);
  EXPECT_TRUE(find_response(table, std::nan(""), phi, alpha).extrapolated);
  EXPECT_TRUE(find_response(table, std::nan(""), phi, alpha).mean.allFinite());
}

}  // namespace
}  // namespace lodestone
