#include "reference/state_archive.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <unordered_set>

#include "tests/message_of.h"

namespace lodestone {
namespace {

struct Inner {
  int number = 0;
  std::vector<double> values;
  void archive(StateArchive& a) { a(number, values); }
  friend bool operator==(const Inner&, const Inner&) = default;
};

struct Whole {
  double x = 0.0;
  std::uint8_t small = 0;
  Vec3 place = Vec3::Zero();
  std::array<Vec3, 2> two{Vec3::Zero(), Vec3::Zero()};
  std::vector<std::int32_t> list;
  std::vector<Inner> inners;
  std::vector<std::vector<float>> lists;
  std::map<std::uint32_t, Inner> ordered;
  std::unordered_map<std::uint64_t, double> hashed;
  std::unordered_set<std::uint32_t> set;
  std::vector<char> none;
  void archive(StateArchive& a) {
    a(x, small, place, two, list, inners);
    a(lists, ordered, hashed, set, none);
  }
  friend bool operator==(const Whole&, const Whole&) = default;
};

Whole example() {
  Whole whole;
  whole.x = -0.0, whole.small = 200, whole.place = {1, 2, std::numeric_limits<double>::infinity()};
  whole.two = {Vec3(1, 2, 3), Vec3(-4, 5, -6)};
  whole.list = {3, -1, 4, -1, 5};
  whole.inners = {{1, {0.5}}, {2, {}}, {3, {1e-300, 1e300}}};
  whole.lists = {{}, {1.0f, 2.0f}, {3.0f}};
  whole.ordered[9] = {9, {9.0}}, whole.ordered[2] = {2, {}};
  for (std::uint64_t i = 0; i < 50; ++i) whole.hashed[i * i * 7919] = double(i) / 3;
  for (std::uint32_t i = 0; i < 50; ++i) whole.set.insert(i * 2654435761u);
  return whole;
}

std::vector<std::byte> bytes_of(Whole whole) {
  StateArchive writer;
  writer(whole);
  EXPECT_FALSE(writer.reading());
  return writer.bytes();
}

TEST(StateArchive, WhatIsWrittenIsReadToTheBit) {
  const std::vector<std::byte> bytes = bytes_of(example());
  StateArchive reader(bytes, {});
  Whole read;
  read.list = {1, 2, 3}, read.hashed[77] = 7.0, read.set = {5}, read.none = {'x'};  // what was there goes
  reader(read);
  EXPECT_TRUE(reader.at_end());
  EXPECT_TRUE(read == example());
  EXPECT_TRUE(std::signbit(read.x));
}

// The order in which a hash map was filled, and how many buckets it has, leave no trace.
TEST(StateArchive, HashedValuesGoInTheOrderOfTheirKeys) {
  Whole other = example();
  other.hashed.clear(), other.set.clear();
  other.hashed.reserve(4096), other.set.reserve(4096);
  for (std::uint64_t i = 50; i-- > 0;) other.hashed[i * i * 7919] = double(i) / 3;
  for (std::uint32_t i = 50; i-- > 0;) other.set.insert(i * 2654435761u);
  EXPECT_EQ(bytes_of(other), bytes_of(example()));
  other.hashed[0] = 1e-300;
  EXPECT_NE(bytes_of(other), bytes_of(example()));
}

// The compiler's own means to clear what lies between members cleared half of a number there.
TEST(StateArchive, WhatStandsBeforeAnArrayAndAGapIsKept) {
  struct Place {
    Vec3 at = Vec3::Zero();
    double gap = 0.0;
  };
  struct Places {
    std::array<Place, 4> places;
    std::int32_t count = 0;
  };
  Places written;
  for (std::size_t i = 0; i < 4; ++i)
    written.places[i] = {Vec3(1.1, 2.2, 3.3) * double(i + 1), 4.4 * double(i + 1)};
  written.count = 4;
  StateArchive writer;
  writer(written);
  Places read;
  StateArchive(writer.bytes(), {})(read);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(read.places[i].at, written.places[i].at) << i;
    EXPECT_EQ(read.places[i].gap, written.places[i].gap) << i;
  }
  EXPECT_EQ(read.count, 4);
}

// Of a value that went nothing is left.
TEST(StateArchive, AnEmptyOptionalIsWrittenAsNothing) {
  std::optional<Vec3> never, gone = Vec3(1, 2, 3), there = Vec3(4, 5, 6);
  gone.reset();
  StateArchive of_never, of_gone, of_there;
  of_never(never), of_gone(gone), of_there(there);
  EXPECT_EQ(of_never.bytes(), std::vector<std::byte>{std::byte(0)});
  EXPECT_EQ(of_gone.bytes(), of_never.bytes());
  std::optional<Vec3> read = Vec3(7, 8, 9);
  StateArchive(of_gone.bytes(), {})(read);
  EXPECT_EQ(read, std::nullopt);
  StateArchive(of_there.bytes(), {})(read);
  EXPECT_EQ(read, there);
}

// Cut anywhere it is an error, never a read beyond the end.
TEST(StateArchive, EveryTruncationIsAnError) {
  const std::vector<std::byte> bytes = bytes_of(example());
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    Whole read;
    StateArchive reader({bytes.data(), length}, {});
    EXPECT_NE(testing::message_of([&] { reader(read); }), testing::kNothingThrown) << length;
  }
}

TEST(StateArchive, WhatIsLeftOverShows) {
  std::vector<std::byte> bytes = bytes_of(example());
  bytes.push_back(std::byte(1));
  StateArchive reader(bytes, {});
  Whole read;
  reader(read);
  EXPECT_FALSE(reader.at_end());
}

// A damaged length asks for no memory that the bytes could not fill.
TEST(StateArchive, AListLongerThanTheBytesIsRefusedBeforeItIsMade) {
  StateArchive writer;
  std::uint64_t count = std::uint64_t(1) << 60;
  writer(count);
  for (int i = 0; i < 2; ++i) {
    StateArchive reader(writer.bytes(), {});
    std::vector<double> doubles;
    std::unordered_map<std::uint32_t, double> map;
    const std::string message =
        i == 0 ? testing::message_of([&] { reader(doubles); }) : testing::message_of([&] { reader(map); });
    EXPECT_EQ(message,
              "state: found a list of 1152921504606846976, expected one of at most the 0 bytes that follow");
    EXPECT_TRUE(doubles.empty() && map.empty());
  }
}

TEST(StateArchive, ShapesAreSharedAfterwardsAsBefore) {
  const auto a = std::make_shared<const Shape>(), b = std::make_shared<const Shape>();
  std::vector<std::shared_ptr<const Shape>> shapes = {b, a, nullptr, b, a};
  StateArchive writer;
  writer(shapes);
  EXPECT_EQ(writer.shapes(), (std::vector<std::shared_ptr<const Shape>>{b, a}));  // as they were met
  const auto c = std::make_shared<const Shape>(), d = std::make_shared<const Shape>();
  StateArchive reader(writer.bytes(), {c, d});
  std::vector<std::shared_ptr<const Shape>> read;
  reader(read);
  EXPECT_EQ(read, (std::vector<std::shared_ptr<const Shape>>{c, d, nullptr, c, d}));
  StateArchive without(writer.bytes(), {c});
  EXPECT_EQ(testing::message_of([&] { without(read); }), "state: found shape 2, expected 0 … 1");
}

}  // namespace
}  // namespace lodestone
