#include "signature/signature_file.h"

#include <gtest/gtest.h>
#include <unistd.h>
#include <xxhash.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include "reference/error.h"
#include "reference/shape.h"
#include "signature/measure/measure.h"
#include "signature/signature_view.h"
#include "tests/temporary_folder.h"

namespace lodestone::signature_file_test {
namespace {

SignatureSettings quick_settings() {
  SignatureSettings settings;
  settings.n_theta = 3, settings.n_phi = 3, settings.n_alpha = 4, settings.trials_per_cell = 8;
  settings.held_out_conditions = 8, settings.height_trials = 50, settings.settling_trials = 24,
  settings.clips = 2;
  return settings;
}

const Signature& box_signature() {
  static const Signature signature =
      measure_signature(make_shape("box", make_box({0.2, 0.3, 0.4})), quick_settings(), 2);
  return signature;
}

using Bytes = std::vector<std::byte>;

// Damage that a checksum does not find: whoever wrote it meant it.
Bytes with_right_checksum(Bytes bytes) {
  const std::uint64_t hash =
      XXH3_64bits(bytes.data() + sizeof(SignatureHeader), bytes.size() - sizeof(SignatureHeader));
  std::memcpy(bytes.data() + offsetof(SignatureHeader, checksum), &hash, sizeof(hash));
  return bytes;
}

void expect_error(const Bytes& bytes, const std::string& message) {
  try {
    load_signature(bytes, "test");
    ADD_FAILURE() << "no error: " << message;
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("test: found " + message), std::string::npos) << error.what();
  }
}

TEST(SignatureFile, RoundTripKeepsEveryByte) {
  for (const ResponseDraw draw :
       {ResponseDraw::independent, ResponseDraw::correlated, ResponseDraw::empirical}) {
    SignatureSettings settings = quick_settings();
    settings.draw = draw, settings.n_theta = settings.n_phi = 1;
    for (const bool paper_grid : {false, true}) {
      settings.paper_grid = paper_grid;
      const Signature signature =
          measure_signature(make_shape("box", make_box({0.2, 0.3, 0.4})), settings, 2);
      const Bytes bytes = encode_signature(signature);
      const Signature back = load_signature(bytes);
      EXPECT_TRUE(encode_signature(back) == bytes);
      EXPECT_EQ(back.settings, settings);
      EXPECT_EQ(back.shape_name, "box");
      EXPECT_EQ(back.by_speed.cells.mean, signature.by_speed.cells.mean);
      EXPECT_EQ(back.bouncing.cells.mean, signature.bouncing.cells.mean);
      EXPECT_EQ(back.mesh_faces, 12U);
    }
  }
}

TEST(SignatureFile, LoadsFromMemoryThatIsNotAligned) {
  const Bytes bytes = encode_signature(box_signature());
  Bytes shifted(1);
  shifted.insert(shifted.end(), bytes.begin(), bytes.end());
  EXPECT_TRUE(encode_signature(load_signature(std::span(shifted).subspan(1))) == bytes);
}

TEST(SignatureFile, LoadsFromAFile) {
  const testing::TemporaryFolder folder;
  const auto file = folder.at("box.sig");
  save_signature(box_signature(), file);
  EXPECT_TRUE(encode_signature(load_signature(file)) == encode_signature(box_signature()));
  EXPECT_EQ(std::filesystem::file_size(file), encode_signature(box_signature()).size());
  std::ofstream(file, std::ios::trunc).close();
  EXPECT_THROW(load_signature(file), InputError);
  std::filesystem::remove(file);
  EXPECT_THROW(load_signature(file), InputError);
  EXPECT_THROW(load_signature(folder.path()), InputError);
}

TEST(SignatureFile, SectionsBeginAtMultiplesOf64) {
  const Bytes bytes = encode_signature(box_signature());
  for (std::size_t i = 0; i < kSections; ++i) {
    SectionEntry entry;
    std::memcpy(&entry, bytes.data() + sizeof(SignatureHeader) + i * sizeof(entry), sizeof(entry));
    EXPECT_EQ(entry.offset % 64, 0U);
  }
}

TEST(SignatureFile, SectionSizesAddUpToTheFile) {
  std::size_t bytes = 0;
  for (const SectionSize& section : list_section_sizes(box_signature())) bytes += section.bytes;
  EXPECT_EQ(bytes, encode_signature(box_signature()).size());
}

TEST(SignatureFile, EveryTruncationIsAnError) {
  const Bytes bytes = encode_signature(box_signature());
  for (std::size_t length = 0; length < bytes.size(); ++length)
    ASSERT_THROW(load_signature(std::span(bytes).first(length)), InputError) << "at " << length;
}

// A header that says that the shorter file is right: what the sections promise is not there.
TEST(SignatureFile, EveryTruncationThatTheHeaderAgreesWithIsAnError) {
  const Bytes bytes = encode_signature(box_signature());
  for (std::size_t length = sizeof(SignatureHeader); length < bytes.size(); length += 1 + length / 200) {
    Bytes shorter(bytes.begin(), bytes.begin() + std::ptrdiff_t(length));
    const std::uint64_t file_bytes = length;
    std::memcpy(shorter.data() + offsetof(SignatureHeader, file_bytes), &file_bytes, sizeof(file_bytes));
    ASSERT_THROW(load_signature(with_right_checksum(shorter)), InputError) << "at " << length;
  }
}

TEST(SignatureFile, EveryFlippedBitIsAnError) {
  Bytes bytes = encode_signature(box_signature());
  for (std::size_t i = 0; i < bytes.size(); i += 1 + i / 200) {
    bytes[i] ^= std::byte{0x10};
    ASSERT_THROW(load_signature(bytes), InputError) << "at " << i;
    bytes[i] ^= std::byte{0x10};
  }
}

// With a right checksum some are: none may crash.
TEST(SignatureFile, DamageThatTheChecksumDoesNotFindIsHarmless) {
  Bytes bytes = encode_signature(box_signature());
  for (std::size_t i = sizeof(SignatureHeader); i < bytes.size(); i += 1 + i / 50)
    for (const std::byte change : {std::byte{0x80}, std::byte{0xff}}) {
      bytes[i] ^= change;
      try {
        load_signature(with_right_checksum(bytes));
      } catch (const InputError&) {
      }
      bytes[i] ^= change;
    }
}

TEST(SignatureFile, TrailingBytesAreAnError) {
  Bytes bytes = encode_signature(box_signature());
  bytes.resize(bytes.size() + 64);
  expect_error(bytes, std::to_string(bytes.size()) + " bytes");
  const std::uint64_t file_bytes = bytes.size();
  std::memcpy(bytes.data() + offsetof(SignatureHeader, file_bytes), &file_bytes, sizeof(file_bytes));
  expect_error(with_right_checksum(bytes), "64 bytes after the last section");
}

TEST(SignatureFile, WrongMagicVersionAndChecksumAreNamed) {
  const Bytes bytes = encode_signature(box_signature());
  Bytes other = bytes;
  other[0] = std::byte{'X'};
  expect_error(other, "a file of another kind");
  other = bytes;
  other[8] = std::byte{99};
  expect_error(other, "format version 99, expected version 4");
  other = bytes;
  other.back() ^= std::byte{1};
  expect_error(other, "a checksum that does not match");
}

// Found by the fuzzer: such a file was read, and written otherwise.
TEST(SignatureFile, BytesBetweenSectionsAreAnError) {
  const Bytes bytes = encode_signature(box_signature());
  int gaps = 0;
  std::uint64_t end = sizeof(SignatureHeader) + kSections * sizeof(SectionEntry);
  for (std::size_t i = 0; i < kSections; ++i) {
    SectionEntry entry;
    std::memcpy(&entry, bytes.data() + sizeof(SignatureHeader) + i * sizeof(SectionEntry), sizeof entry);
    if (entry.offset > end) {
      Bytes damaged = bytes;
      damaged[end] = std::byte(1), ++gaps;
      expect_error(with_right_checksum(damaged), "bytes between the sections");
    }
    end = entry.offset + entry.count * entry.value_bytes;
  }
  EXPECT_GT(gaps, 0);
}

// Sections whose sizes do not fit, or overflow when they are multiplied or added.
TEST(SignatureFile, SizesThatOverflowAreAnError) {
  const Bytes bytes = encode_signature(box_signature());
  for (std::size_t section = 0; section < kSections; ++section)
    for (const std::uint64_t count : {~std::uint64_t(0), ~std::uint64_t(0) / 24 + 1, std::uint64_t(1) << 62,
                                      std::uint64_t(bytes.size())}) {
      for (const std::size_t field : {offsetof(SectionEntry, count), offsetof(SectionEntry, offset)}) {
        Bytes damaged = bytes;
        std::memcpy(damaged.data() + sizeof(SignatureHeader) + section * sizeof(SectionEntry) + field, &count,
                    sizeof(count));
        expect_error(with_right_checksum(damaged), "section " + std::to_string(section));
      }
    }
}

// What an encoder that is not ours might write.
TEST(SignatureFile, ImpossibleContentIsAnError) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto expect_impossible = [](const std::string& message, auto change) {
    Signature signature = box_signature();
    change(signature);
    expect_error(encode_signature(signature), message);
  };
  expect_impossible("a response that is not finite",
                    [&](Signature& s) { s.bouncing.cells.mean[3][2] = nan; });
  expect_impossible("a deviation that is negative",
                    [&](Signature& s) { s.non_bouncing.cells.deviation[1][0] = -1e-3f; });
  expect_impossible("a deviation that is negative",
                    [&](Signature& s) { s.non_bouncing.cells.deviation[1][0] = nan; });
  expect_impossible("an impossible approach",
                    [&](Signature& s) { s.bouncing.cells.approach[0].deviation = -1.0f; });
  expect_impossible("a response table whose lists do not fit", [&](Signature& s) { s.bouncing.n_theta = 4; });
  expect_impossible("an axis of -3 samples",
                    [&](Signature& s) { s.bouncing.n_theta = -3, s.bouncing.n_phi = -3; });
  expect_impossible("an axis of 2147483647 samples", [&](Signature& s) { s.bouncing.n_theta = 2147483647; });
  expect_impossible("a response table whose lists do not fit",
                    [&](Signature& s) { s.bouncing.cells.trials.pop_back(); });
  expect_impossible("samples outside of their cells", [&](Signature& s) {
    s.bouncing.cells.first_sample.assign(s.bouncing.cells.mean.size() + 1, 7);
  });
  expect_impossible("covariances or samples of one scale-free table alone",
                    [&](Signature& s) { s.bouncing.cells.factor.resize(s.bouncing.cells.mean.size()); });
  expect_impossible("covariances or samples of one scale-free table alone", [&](Signature& s) {
    s.bouncing.cells.first_sample.assign(s.bouncing.cells.mean.size() + 1, 1);
    s.bouncing.cells.first_sample.front() = 0, s.bouncing.cells.sample.resize(1);
  });
  expect_impossible("an axis that does not rise", [&](Signature& s) { s.by_speed.speeds = {1.0f, 1.0f}; });
  expect_impossible("an axis that does not rise", [&](Signature& s) { s.by_speed.spins = {1.0f, nan}; });
  expect_impossible("response tables of neither kind",
                    [&](Signature& s) { s.bouncing = s.non_bouncing = {}; });
  expect_impossible("an impossible collision height",
                    [&](Signature& s) { s.collision_heights.mean[0] = nan; });
  expect_impossible("an impossible collision height",
                    [&](Signature& s) { s.collision_heights.mean[0] = 1.5f; });
  expect_impossible("an impossible deviation of the collision height",
                    [&](Signature& s) { s.collision_heights.deviation[0] = -0.1f; });
  expect_impossible("collision heights whose lists differ",
                    [&](Signature& s) { s.collision_heights.deviation.pop_back(); });
  expect_impossible("an impossible rest pose", [&](Signature& s) { s.rest_poses[0].normal *= 2.0; });
  expect_impossible("an impossible rest pose", [&](Signature& s) { s.rest_poses[0].frequency = nan; });
  expect_impossible("a settling clip outside", [&](Signature& s) { s.clips.back().frames += 1; });
  expect_impossible("a settling clip outside", [&](Signature& s) { s.clips[0].first_frame = ~0u; });
  expect_impossible("an entry into a clip that is not there",
                    [&](Signature& s) { s.clip_entries[0].clip = 9; });
  expect_impossible("a clip frame interval", [&](Signature& s) { s.clip_frame_interval = 0.0f; });
  expect_impossible("an impossible contact law", [&](Signature& s) { s.settings.law.restitution = 1.5; });
  expect_impossible("a setting of no known kind", [&](Signature& s) { s.settings.draw = ResponseDraw(9); });
  expect_impossible("an impossible certificate",
                    [&](Signature& s) { s.bouncing_certificate.held_out_ks = nan; });
}

TEST(SignatureFile, AnotherMeshIsNamed) {
  check_measured_for(box_signature(), make_shape("box", make_box({0.2, 0.3, 0.4})), "file.sig");
  check_measured_for(box_signature(), make_shape("larger", make_box({0.4, 0.6, 0.8})), "file.sig");
  EXPECT_THROW(
      check_measured_for(box_signature(), make_shape("other", make_box({0.2, 0.3, 0.5})), "file.sig"),
      InputError);
}

}  // namespace
}  // namespace lodestone::signature_file_test
