#include "signature/measure/make_clips.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "reference/drop_trial.h"
#include "signature/measure/settling_trial.h"
#include "signature/settling_clips.h"
#include "tests/signature/few_units.h"

namespace lodestone {
namespace {

struct Recorded {
  Shape shape = testing::measured_box();
  std::vector<SettlingRecord> records;
  Signature signature;
  Recorded() {
    SettlingTrial trial(std::make_shared<const Shape>(shape), {0.4, 0.5});
    for (std::uint32_t i = 0; i < 8; ++i) records.push_back(trial.run(3, i, true));
    for (const SettlingRecord& record : records)
      if (record.rests)
        signature.rest_poses.push_back({.normal = record.normal, .frequency = 1.0 / 8});
    add_clips(records, shape, 3, signature);
  }
};

const Recorded& recorded() {
  static const Recorded made;
  return made;
}

TEST(MakeClips, ClipsLieOneAfterTheOther) {
  const Signature& s = recorded().signature;
  ASSERT_GT(s.clips.size(), 0U);
  EXPECT_LE(s.clips.size(), 3U);
  std::uint32_t next = 0;
  for (const SettlingClip& clip : s.clips) {
    EXPECT_EQ(clip.first_frame, next);
    EXPECT_GT(clip.frames, 1U);
    next += clip.frames;
  }
  EXPECT_EQ(s.clip_frames.size(), next);
}

// Decoded, a clip is the record that it was made of, to 16 bits: moved to begin at the origin, over R.
TEST(MakeClips, FramesAreTheStatesOfARecord) {
  const auto& [shape, records, signature] = recorded();
  for (const SettlingClip& clip : signature.clips) {
    const auto record = std::ranges::find_if(
        records, [&](const SettlingRecord& r) {
          if (r.states.size() != clip.frames) return false;
          const ClipState first = decode_frame(signature.clip_frames[clip.first_frame], clip.extent);
          return std::abs(first.orientation.dot(r.states[0].orientation)) > 1.0 - 1e-6;
        });
    ASSERT_NE(record, records.end());
    const Vec3 start(record->states[0].position.x(), record->states[0].position.y(), 0.0);
    const double unit = std::sqrt(kSettlingGravity * shape.radius);
    for (std::uint32_t i = 0; i < clip.frames; ++i) {
      const ClipState state = decode_frame(signature.clip_frames[clip.first_frame + i], clip.extent);
      const RigidState& was = record->states[i];
      const double fine = (double(clip.extent) + kClipHeightRange) / 30000;
      EXPECT_LT((state.position - (was.position - start) / shape.radius).norm(), 2.0 * fine);
      EXPECT_GT(std::abs(state.orientation.dot(was.orientation)), 1.0 - 1e-7);
      EXPECT_LT((state.velocity - was.velocity / unit).norm(), 4.0 * kClipSpeedRange / 30000);
    }
  }
}

// Where a body may join a clip it touches the ground and has little energy.
TEST(MakeClips, EntriesAreSlowContacts) {
  const auto& [shape, records, signature] = recorded();
  ASSERT_FALSE(signature.clip_entries.empty());
  for (std::size_t i = 0; i < signature.clip_entries.size(); ++i) {
    const ClipEntry entry = signature.clip_entries[i];
    ASSERT_LT(entry.clip, signature.clips.size());
    ASSERT_LT(entry.frame, signature.clips[entry.clip].frames);
    if (i > 0 && signature.clip_entries[i - 1].clip == entry.clip) {
      EXPECT_GT(entry.frame, signature.clip_entries[i - 1].frame);
    }
    const ClipState state = find_clip_state(signature, signature.clips[entry.clip], entry.frame);
    double lowest = 1e9;
    for (const Vec3& vertex : shape.hull.vertices)
      lowest = std::min(lowest, (state.orientation * vertex).z() / shape.radius + state.position.z());
    EXPECT_LT(lowest, kEntryGap + 1e-3);
    EXPECT_LT(0.5 * state.velocity.squaredNorm(), kClipEnergy + 1e-3);
  }
}

// A frame every sixtieth of a second at the size of the record, less often for a larger body.
TEST(MakeClips, TimeBetweenFramesIsWithoutUnits) {
  const double interval = double(recorded().signature.clip_frame_interval);
  EXPECT_NEAR(interval * std::sqrt(recorded().shape.radius / kSettlingGravity), kObservationStep, 1e-6);
}

TEST(MakeClips, NoneWhereNoneIsAskedFor) {
  Signature none;
  none.rest_poses = recorded().signature.rest_poses;
  add_clips(recorded().records, recorded().shape, 0, none);
  EXPECT_TRUE(none.clips.empty() && none.clip_frames.empty() && none.clip_entries.empty());
}

}  // namespace
}  // namespace lodestone
