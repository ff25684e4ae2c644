#include "signature/byte_archive.h"

#include <gtest/gtest.h>

namespace lodestone {
namespace {

enum class Colour : std::uint8_t { red, green };

struct Inner {
  double number = 0.0;
  std::vector<std::string> words;
  friend bool operator==(const Inner&, const Inner&) = default;
};
template <class Archive>
void archive(Archive& a, Archived<Inner> auto& inner) {
  a(inner.number, inner.words);
}

struct Outer {
  std::int64_t count = 0;
  bool yes = false;
  Colour colour = Colour::red;
  Vec3 place = Vec3::Zero();
  std::array<std::uint16_t, 3> three{};
  std::optional<Inner> maybe;
  std::vector<Inner> list;
  friend bool operator==(const Outer&, const Outer&) = default;
};
template <class Archive>
void archive(Archive& a, Archived<Outer> auto& o) {
  a(o.count, o.yes, o.colour, o.place, o.three, o.maybe, o.list);
}

Outer some() {
  return {.count = -7,
          .yes = true,
          .colour = Colour::green,
          .place = {1.5, -2.5, 1e300},
          .three = {1, 2, 65535},
          .maybe = Inner{0.1, {"a", ""}},
          .list = {{1.0, {}}, {-0.0, {"word"}}}};
}

std::vector<std::byte> bytes_of(const auto&... values) {
  ByteWriter writer;
  writer(values...);
  return writer.bytes;
}

TEST(ByteArchive, WhatIsWrittenComesBack) {
  const std::vector<std::byte> bytes = bytes_of(some());
  Outer back;
  ByteReader reader(bytes);
  reader(back);
  EXPECT_TRUE(reader.whole());
  EXPECT_TRUE(back == some());
}

TEST(ByteArchive, IsLittleEndianWithoutGaps) {
  const auto bytes = bytes_of(std::uint32_t(0x01020304), true, std::uint16_t(0x0506), std::string("ab"),
                              std::optional<char>(), Quat(1, 0, 0, 0));
  ASSERT_EQ(bytes.size(), 4 + 1 + 2 + 8 + 2 + 1 + 32U);
  const int expected[] = {4, 3, 2, 1, 1, 6, 5, 2, 0, 0, 0, 0, 0, 0, 0, 'a', 'b', 0};
  for (std::size_t i = 0; i < std::size(expected); ++i) EXPECT_EQ(int(bytes[i]), expected[i]) << i;
}

// w comes first, whatever order Eigen keeps them in.
TEST(ByteArchive, QuaternionsComeBack) {
  const Quat q(0.1, 0.2, 0.3, 0.4);
  const std::vector<std::byte> bytes = bytes_of(q);
  Quat back;
  ByteReader reader(bytes);
  reader(back);
  EXPECT_EQ(back.coeffs(), q.coeffs());
}

TEST(ByteArchive, CutAnywhereItIsNotWhole) {
  const std::vector<std::byte> bytes = bytes_of(some());
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    Outer back;
    ByteReader reader{std::span(bytes).first(length)};
    reader(back);
    EXPECT_FALSE(reader.whole()) << length;
    EXPECT_FALSE(reader.good()) << length;
  }
}

TEST(ByteArchive, MoreThanIsAskedForIsNotWholeEither) {
  const auto bytes = bytes_of(std::uint8_t(1), std::uint8_t(2));
  std::uint8_t one = 0;
  ByteReader reader(bytes);
  reader(one);
  EXPECT_TRUE(reader.good());
  EXPECT_FALSE(reader.whole());
  EXPECT_EQ(reader.left(), 1U);
}

// A damaged length does not make it set aside gigabytes, nor read on.
TEST(ByteArchive, ListsLongerThanTheBytesAreRefused) {
  const auto bytes = bytes_of(std::uint64_t(1) << 60, std::uint64_t(7));
  std::vector<std::uint64_t> list = {1, 2, 3};
  ByteReader reader(bytes);
  reader(list);
  EXPECT_FALSE(reader.good());
  EXPECT_TRUE(list.empty());
  std::uint64_t next = 5;
  reader(next);
  EXPECT_EQ(next, 0U);
  std::string text = "before";
  ByteReader again(bytes);
  again(text);
  EXPECT_TRUE(text.empty());
  EXPECT_FALSE(again.good());
}

TEST(ByteArchive, ATruthIsZeroOrOne) {
  for (const int byte : {0, 1, 2, 255}) {
    const std::byte bytes[] = {std::byte(byte)};
    bool truth = false;
    ByteReader reader(bytes);
    reader(truth);
    EXPECT_EQ(reader.good(), byte < 2);
    EXPECT_EQ(truth, byte == 1);
  }
}

}  // namespace
}  // namespace lodestone
