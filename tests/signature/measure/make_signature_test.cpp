#include <gtest/gtest.h>

#include <algorithm>

#include "reference/drop_trial.h"
#include "signature/measure/measure.h"
#include "signature/measure/measurement_shape.h"
#include "signature/measure/settling_trial.h"
#include "signature/settling_clips.h"
#include "signature/signature_file.h"
#include "tests/signature/few_units.h"

namespace lodestone {
namespace {

struct Recorded {
  std::shared_ptr<const Shape> shape = make_measurement_shape(testing::measured_box());
  std::vector<SettlingRecord> records;
  Signature signature;
  explicit Recorded(int clips) {
    SignatureSettings settings = testing::few_trials();
    settings.settling_trials = 8, settings.clips = clips;
    const Measurement measured = measure_units(testing::measured_box(), settings, {}, {.threads = 1});
    records = measured.settlings;
    signature = make_signature(testing::measured_box(), settings, measured);
  }
};

const Recorded& recorded() {
  static const Recorded made(3);
  return made;
}

TEST(MakeSignature, ClipsLieOneAfterTheOther) {
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
TEST(MakeSignature, FramesAreTheStatesOfARecord) {
  const std::shared_ptr<const Shape>& shape = recorded().shape;
  const std::vector<SettlingRecord>& records = recorded().records;
  const Signature& signature = recorded().signature;
  ASSERT_FALSE(signature.clips.empty());
  for (const SettlingClip& clip : signature.clips) {
    const auto record = std::ranges::find_if(records, [&](const SettlingRecord& r) {
      if (r.states.size() != clip.frames) return false;
      const ClipState first = decode_frame(signature.clip_frames[clip.first_frame], clip.extent);
      return std::abs(first.orientation.dot(r.states[0].orientation)) > 1.0 - 1e-6;
    });
    ASSERT_NE(record, records.end());
    const Vec3 start(record->states[0].position.x(), record->states[0].position.y(), 0.0);
    const double unit = std::sqrt(kSettlingGravity * shape->radius);
    for (std::uint32_t i = 0; i < clip.frames; ++i) {
      const ClipState state = decode_frame(signature.clip_frames[clip.first_frame + i], clip.extent);
      const RigidState& was = record->states[i];
      const double fine = (double(clip.extent) + kClipHeightRange) / 30000;
      EXPECT_LT((state.position - (was.position - start) / shape->radius).norm(), 2.0 * fine);
      EXPECT_GT(std::abs(state.orientation.dot(was.orientation)), 1.0 - 1e-7);
      EXPECT_LT((state.velocity - was.velocity / unit).norm(), 4.0 * kClipSpeedRange / 30000);
    }
  }
}

// Where a body may join a clip it touches the ground and has little energy.
TEST(MakeSignature, EntriesAreSlowContacts) {
  const std::shared_ptr<const Shape>& shape = recorded().shape;
  const Signature& signature = recorded().signature;
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
    for (const Vec3& vertex : shape->hull.vertices)
      lowest = std::min(lowest, (state.orientation * vertex).z() / shape->radius + state.position.z());
    EXPECT_LT(lowest, kEntryGap + 1e-3);
    EXPECT_LT(0.5 * state.velocity.squaredNorm(), kClipEnergy + 1e-3);
  }
}

// A frame every sixtieth of a second at the size of the record, less often for a larger body.
TEST(MakeSignature, TimeBetweenFramesIsWithoutUnits) {
  const double interval = double(recorded().signature.clip_frame_interval);
  EXPECT_NEAR(interval * std::sqrt(recorded().shape->radius / kSettlingGravity), kObservationStep, 1e-6);
}

TEST(MakeSignature, NoClipsWhereNoneAreAskedFor) {
  const Signature none = Recorded(0).signature;
  EXPECT_TRUE(none.clips.empty() && none.clip_frames.empty() && none.clip_entries.empty());
  EXPECT_FALSE(none.rest_poses.empty());
}

// Of the trials that came to rest each is in one pose, at the height that the hull has there.
TEST(MakeSignature, RestPosesAreThoseOfTheTrials) {
  const std::shared_ptr<const Shape>& shape = recorded().shape;
  const std::vector<SettlingRecord>& records = recorded().records;
  const Signature& signature = recorded().signature;
  double sum = 0.0;
  for (const RestPose& pose : signature.rest_poses) {
    sum += pose.frequency;
    EXPECT_NEAR(pose.normal.norm(), 1.0, 1e-9);
    double lowest = 0.0;
    for (const Vec3& vertex : shape->hull.vertices) lowest = std::min(lowest, pose.normal.dot(vertex));
    EXPECT_NEAR(pose.height, -lowest / shape->radius, 0.01);
  }
  EXPECT_LE(sum, 1.0 + 1e-9);
  const auto rested = std::ranges::count_if(records, [](const SettlingRecord& r) { return r.rests; });
  EXPECT_NEAR(sum, double(rested) / double(records.size()), 1e-9);
  EXPECT_TRUE(std::ranges::is_sorted(signature.rest_poses, std::greater<>{}, &RestPose::frequency));
}

// Made twice of the same units it is the same.
TEST(MakeSignature, IsAFunctionOfItsUnits) {
  EXPECT_EQ(encode_signature(Recorded(1).signature), encode_signature(Recorded(1).signature));
}

}  // namespace
}  // namespace lodestone
