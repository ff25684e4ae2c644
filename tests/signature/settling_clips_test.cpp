#include "signature/settling_clips.h"

#include <gtest/gtest.h>

#include "reference/random.h"

namespace lodestone::settling_clips_test {
namespace {

constexpr int kClips = 600;

ClipState random_state(std::uint32_t number) {
  RandomStream random(31, number, 0);
  const Quat orientation = random.orientation();
  return {{0, 0, random.uniform(0.5, 1.0)},
          orientation,
          random.uniform(0, 0.4) * random.direction(),
          random.uniform(0, 0.4) * random.direction()};
}

// Clips of one frame, each with an entry.
Signature random_clips() {
  Signature signature;
  for (std::uint32_t i = 0; i < kClips; ++i) {
    signature.clips.push_back({.first_frame = i, .frames = 1, .extent = 1.0f});
    signature.clip_frames.push_back(encode_frame(random_state(i), 1.0f));
    signature.clip_entries.push_back({.clip = i, .frame = 0});
  }
  return signature;
}

SettlingKey key_of(const ClipState& s) {
  const Quat to_body = s.orientation.conjugate();
  const Vec3 omega = to_body * s.angular_velocity;
  return {(to_body * Vec3::UnitZ()).cast<float>(), (to_body * s.velocity).cast<float>(), omega.cast<float>(),
          float(0.5 * (s.velocity.squaredNorm() + omega.squaredNorm()) + s.position.z())};
}

float distance(const SettlingKey& a, const SettlingKey& b) {
  return 4.0f * (a.normal - b.normal).squaredNorm() + (a.velocity - b.velocity).squaredNorm() +
         (a.angular_velocity - b.angular_velocity).squaredNorm();
}

TEST(SettlingClips, TheNearestEntryIsThatOfALookAtAll) {
  const Signature signature = random_clips();
  const ClipIndex index(signature, Mat3::Identity());
  int found = 0, none = 0;
  for (std::uint32_t i = 0; i < 2000; ++i) {
    RandomStream random(32, i, 0);
    const SettlingKey key = key_of(random_state(100'000 + i));
    const float limit = float(random.uniform(0.02, 0.4)), slack = 0.01f;
    int nearest = -1;
    float least = limit;
    for (int k = 0; k < kClips; ++k) {
      const SettlingKey other = key_of(find_clip_state(signature, signature.clips[std::size_t(k)], 0.0));
      if (other.energy <= key.energy + slack && distance(key, other) < least)
        least = distance(key, other), nearest = k;
    }
    const std::optional<ClipEntry> entry = index.find_nearest(key, slack, limit);
    EXPECT_EQ(entry ? int(entry->clip) : -1, nearest) << i;
    ++(nearest < 0 ? none : found);
  }
  EXPECT_GT(found, 200);
  EXPECT_GT(none, 200);
}

TEST(SettlingClips, WithoutEntriesNothingIsFound) {
  const ClipIndex index(Signature(), Mat3::Identity());
  EXPECT_TRUE(index.empty());
  EXPECT_FALSE(index.find_nearest({}, 1.0f, 1.0f));
}

// Poses between frames lie between theirs; velocities stay those of the frame before.
TEST(SettlingClips, BetweenFramesPosesAreBlended) {
  Signature signature;
  const ClipState first{{0, 0, 1}, Quat::Identity(), {0.3, 0, 0}, {0, 0, 0.2}};
  const ClipState second{{0.1, 0, 0.9}, rotation_from_vector({0, 0, 0.2}), {0.1, 0, 0}, {0, 0, 0.1}};
  signature.clips = {{.first_frame = 0, .frames = 2, .extent = 1.0f}};
  signature.clip_frames = {encode_frame(first, 1.0f), encode_frame(second, 1.0f)};
  const ClipState between = find_clip_state(signature, signature.clips[0], 0.25);
  EXPECT_LT((between.position - Vec3(0.025, 0, 0.975)).norm(), 2e-4);
  EXPECT_LT(between.orientation.angularDistance(rotation_from_vector({0, 0, 0.05})), 2e-4);
  EXPECT_NEAR(between.orientation.norm(), 1.0, 1e-12);
  EXPECT_LT((between.velocity - first.velocity).norm(), 2e-4);
  EXPECT_LT((find_clip_state(signature, signature.clips[0], 9.0).position - second.position).norm(), 2e-4);
}

}  // namespace
}  // namespace lodestone::settling_clips_test
