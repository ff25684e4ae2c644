#include "signature/measure/unit_records.h"

#include <gtest/gtest.h>

#include "reference/error.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

MeasurementIdentity some_identity() {
  MeasurementIdentity identity;
  identity.versions = "3 2 0.16";
  identity.settings.seed = 77, identity.settings.law = {0.3, 0.6};
  identity.share = {.index = 2, .count = 5};
  identity.shape = *testing::box_shape({0.2, 0.3, 0.4});
  return identity;
}

std::string fault_of(std::span<const std::byte> bytes) {
  try {
    decode_head(bytes, "part.lodepart");
  } catch (const InputError& fault) {
    return fault.what();
  }
  return "";
}

TEST(UnitRecords, AHeadComesBackAndIsTakenOff) {
  std::vector<std::byte> bytes = encode_head(some_identity());
  bytes.push_back(std::byte(42));
  std::span<const std::byte> left = bytes;
  const MeasurementIdentity back = decode_head(left, "part");
  EXPECT_EQ(left.size(), 1U);
  EXPECT_EQ(left[0], std::byte(42));
  EXPECT_EQ(back.versions, "3 2 0.16");
  EXPECT_TRUE(back.settings == some_identity().settings);
  EXPECT_EQ(back.share.index, 2);
  EXPECT_EQ(back.share.count, 5);
  EXPECT_EQ(back.shape.content_hash, some_identity().shape.content_hash);
  EXPECT_EQ(back.shape.radius, some_identity().shape.radius);
  EXPECT_EQ(back.shape.mesh.vertices, some_identity().shape.mesh.vertices);
  EXPECT_EQ(back.shape.mesh.faces, some_identity().shape.mesh.faces);
}

TEST(UnitRecords, AHeadCutOrDamagedAnywhereIsRefusedByName) {
  const std::vector<std::byte> bytes = encode_head(some_identity());
  for (std::size_t length = 0; length < bytes.size(); length += length < 64 ? 1 : 37)
    EXPECT_TRUE(fault_of(std::span(bytes).first(length)).starts_with("part.lodepart: found ")) << length;
  for (std::size_t i = 0; i < bytes.size(); i += i < 64 ? 1 : 37) {
    std::vector<std::byte> damaged = bytes;
    damaged[i] ^= std::byte(4);
    EXPECT_FALSE(fault_of(damaged).empty()) << i;
  }
  EXPECT_NE(fault_of({}).find("another kind"), std::string::npos);
}

std::vector<std::byte> three_records() {
  std::vector<std::byte> all;
  for (int i = 0; i < 3; ++i) {
    const std::vector<std::byte> own(std::size_t(10 * i), std::byte(i));  // the first has none
    const auto record = encode_record({UnitKind::bouncing, 100 + i, 0.5 * i, own});
    all.insert(all.end(), record.begin(), record.end());
  }
  return all;
}

TEST(UnitRecords, ComeBackOneAfterTheOther) {
  const std::vector<std::byte> bytes = three_records();
  std::span<const std::byte> left = bytes;
  const std::vector<UnitRecord> records = take_records(left);
  EXPECT_TRUE(left.empty());
  ASSERT_EQ(records.size(), 3U);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(records[i].kind, UnitKind::bouncing);
    EXPECT_EQ(records[i].unit, 100 + i);
    EXPECT_EQ(records[i].seconds, 0.5 * i);
    EXPECT_EQ(records[i].bytes.size(), std::size_t(10 * i));
    for (const std::byte byte : records[i].bytes) EXPECT_EQ(byte, std::byte(i));
  }
}

// However a file ends, or wherever it is damaged: what is before stays, and what follows is left.
TEST(UnitRecords, OnlyWholeOnesAreTaken) {
  const std::vector<std::byte> bytes = three_records();
  const std::size_t record = 4 * sizeof(std::uint64_t), ends[] = {record, 2 * record + 10, 3 * record + 30};
  ASSERT_EQ(bytes.size(), ends[2]);
  for (std::size_t length = 0; length <= bytes.size(); ++length) {
    std::span<const std::byte> left = std::span(bytes).first(length);
    const std::size_t whole = (length >= ends[0]) + (length >= ends[1]) + (length >= ends[2]);
    EXPECT_EQ(take_records(left).size(), whole) << length;
    EXPECT_EQ(left.size(), length - (whole > 0 ? ends[whole - 1] : 0)) << length;
  }
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::vector<std::byte> damaged = bytes;
    damaged[at] ^= std::byte(1);
    std::span<const std::byte> left = damaged;
    EXPECT_EQ(take_records(left).size(), std::size_t((at >= ends[0]) + (at >= ends[1]))) << at;
  }
}

}  // namespace
}  // namespace lodestone
