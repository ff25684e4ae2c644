#include "signature/measure/measurement_part.h"

#include <gtest/gtest.h>

#include "signature/measure/measure.h"
#include "signature/signature_file.h"
#include "signature/signature_source.h"
#include "tests/message_of.h"
#include "tests/signature/few_units.h"
#include "tests/temporary_folder.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;
using testing::few_trials;
using testing::measured_box;

SignatureSourceSettings uncached(std::uint64_t seed = 1) {
  SignatureSourceSettings settings;
  settings.measuring = few_trials();
  settings.measuring.seed = seed;
  settings.use_cache = false, settings.threads = 1;
  return settings;
}

const std::vector<MeasurementPart>& parts_of_three() {
  static const std::vector<MeasurementPart> parts = [] {
    std::vector<MeasurementPart> made;
    for (int i = 0; i < 3; ++i) made.push_back(measure_part(measured_box(), {}, {i, 3}, uncached()));
    return made;
  }();
  return parts;
}

class Parts : public ::testing::Test {
 protected:
  Parts() {
    for (int i = 0; i < 3; ++i) {
      files_.push_back(folder_.at("part" + std::to_string(i)));
      save_part(parts_of_three()[std::size_t(i)], files_.back());
    }
  }
  std::string fault(const std::vector<fs::path>& files) const {
    return testing::message_of([&] { merge_parts(files); });
  }
  /// Of another measurement, as a file.
  fs::path other(const Shape& shape, const ContactLaw& law, const Share& share, std::uint64_t seed = 1) {
    const fs::path file = folder_.at("other");
    save_part(measure_part(shape, law, share, uncached(seed)), file);
    return file;
  }
  const testing::TemporaryFolder folder_;
  std::vector<fs::path> files_;
};

TEST_F(Parts, TogetherTheyAreTheSignatureOfOneProcessInAnyOrder) {
  const auto whole = encode_signature(measure_signature(measured_box(), few_trials(), 1));
  EXPECT_EQ(encode_signature(merge_parts(files_)), whole);
  EXPECT_EQ(encode_signature(merge_parts(std::vector{files_[2], files_[0], files_[1]})), whole);
  double seconds = 0.0;
  for (const MeasurementPart& part : parts_of_three()) seconds += part.seconds;
  EXPECT_NEAR(merge_parts(files_).measuring_seconds, seconds, 1e-9);
}

TEST_F(Parts, ComeBackFromAFileAsTheyWere) {
  for (int i = 0; i < 3; ++i) {
    const MeasurementPart read = load_part(files_[std::size_t(i)]);
    EXPECT_EQ(encode_part(read), encode_part(parts_of_three()[std::size_t(i)]));
    EXPECT_EQ(read.identity.share.index, i);
    EXPECT_EQ(read.identity.shape.content_hash, measured_box().content_hash);
  }
}

TEST_F(Parts, TrialsAddUpToThoseOfTheWhole) {
  std::uint64_t trials = 0;
  for (const MeasurementPart& part : parts_of_three()) trials += count_trials(part);
  EXPECT_EQ(trials, count_trials(measure_part(measured_box(), {}, {}, uncached())));
  const SignatureSettings settings = few_trials();
  EXPECT_GE(trials, std::uint64_t(settings.height_samples * settings.height_trials + 2 * 8 * 4 +
                                  settings.settling_trials));
}

TEST_F(Parts, CutAnywhereIsRefusedByName) {
  const std::string sound = testing::bytes_of(files_[1]);
  for (std::size_t length = 0; length < sound.size(); length += 1 + sound.size() / 60) {
    folder_.write("part1", sound.substr(0, length));
    const std::string message = testing::message_of([&] { load_part(files_[1]); });
    EXPECT_TRUE(message.starts_with(files_[1].string() + ": found ")) << length << ' ' << message;
  }
  folder_.write("part1", sound + "x");
  EXPECT_NE(testing::message_of([&] { load_part(files_[1]); }), testing::kNothingThrown);
}

TEST_F(Parts, DamageAtAnyByteIsRefused) {
  const std::string sound = testing::bytes_of(files_[0]);
  for (std::size_t at = 0; at < sound.size(); at += 1 + sound.size() / 80) {
    std::string damaged = sound;
    damaged[at] = char(damaged[at] ^ 0x20);
    folder_.write("part0", damaged);
    EXPECT_NE(testing::message_of([&] { load_part(files_[0]); }), testing::kNothingThrown) << at;
  }
}

TEST_F(Parts, EachIsToBeThereOnce) {
  EXPECT_EQ(fault({files_[0], files_[2]}),
            "merge: found no part 2/3 among 2 files, expected all of 1/3 to 3/3");
  EXPECT_EQ(fault({files_[0], files_[1], files_[2], files_[1]}),
            files_[1].string() + ": found part 2 of 3 again, expected each part once (" + files_[1].string() +
                " is it, too)");
}

TEST_F(Parts, OfAnotherMeasurementIsNamedWithWhatDiffers) {
  const auto with = [&](const fs::path& file) { return fault({files_[0], files_[1], file}); };
  const Shape cube = make_shape("cube", make_box({0.3, 0.3, 0.3}));
  EXPECT_NE(with(other(cube, {}, {2, 3})).find("found shape cube"), std::string::npos);
  EXPECT_NE(with(other(measured_box(), {0.1, 0.5}, {2, 3})).find("found other settings"), std::string::npos);
  EXPECT_NE(with(other(measured_box(), {}, {2, 3}, 5)).find("found other settings"), std::string::npos);
  EXPECT_NE(with(other(measured_box(), {}, {1, 2})).find("expected a part of 3"), std::string::npos);
}

TEST_F(Parts, WhatIsNoPartIsRefused) {
  EXPECT_NE(fault({folder_.write("text", "not a part at all, but some text")}), testing::kNothingThrown);
  EXPECT_NE(fault({folder_.at("none")}), testing::kNothingThrown);
  EXPECT_NE(fault({folder_.path()}), testing::kNothingThrown);
}

}  // namespace
}  // namespace lodestone
