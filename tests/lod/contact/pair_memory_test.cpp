#include "lod/contact/pair_memory.h"

#include <gtest/gtest.h>

#include <map>

#include "reference/random.h"

namespace lodestone {
namespace {

TEST(PairMemory, KeysTellPairsAndPlanesApart) {
  EXPECT_NE(contact_key(1, 2), contact_key(2, 1));
  EXPECT_EQ(contact_key(1, 2), contact_key(1, 2));
  EXPECT_EQ(ground_key(7, 0), contact_key(7, 0xffffffff));
  EXPECT_NE(ground_key(7, 0), ground_key(7, 1));
}

// The first place of each key, however far from where it was expected.
TEST(PairMemory, FindsWhereEachWasAdded) {
  PairMemory memory;
  RandomStream random(5, 0, 0);
  const auto draw = [&] {
    return contact_key(std::uint32_t(random.uniform(0, 40)), std::uint32_t(random.uniform(0, 40)));
  };
  for (int round = 0; round < 3; ++round) {
    memory.clear();
    std::map<ContactKey, std::int32_t> first;
    for (std::int32_t i = 0; i < 500; ++i) {
      const ContactKey key = draw();
      first.emplace(key, i);
      memory.add(key);
    }
    std::size_t found_again = 0;
    for (int i = 0; i < 2'000; ++i) {
      const ContactKey key = draw();
      const auto known = first.find(key);
      const std::int32_t place = memory.find(key, 1'000'000);
      ASSERT_EQ(place, known == first.end() ? -1 : known->second);
      found_again += place >= 0;
    }
    EXPECT_GT(found_again, 100U);
  }
}

// Many more keys than the lists before had: the marks that show most strangers are too few then, and only
// slower.
TEST(PairMemory, GrowingListsHideNoKey) {
  PairMemory memory;
  for (const std::uint32_t count : {3U, 3'000U, 10U, 40'000U}) {
    memory.clear();
    for (std::uint32_t i = 0; i < count; ++i) memory.add(contact_key(i, 7 * i + 1));
    for (std::uint32_t i = 0; i < count; ++i)
      ASSERT_EQ(memory.find(contact_key(i, 7 * i + 1), count - i), std::int32_t(i)) << count;
    for (std::uint32_t i = 0; i < count; ++i) ASSERT_EQ(memory.find(contact_key(i, 7 * i + 2), i), -1);
  }
}

TEST(PairMemory, WhatIsReadBackFindsAsWhatWasWritten) {
  PairMemory written, read;
  for (std::uint32_t i = 0; i < 100; ++i) written.add(contact_key(i * i, i));
  StateArchive out;
  out(written);
  read.add(contact_key(5, 5));
  StateArchive in(out.bytes(), {});
  in(read);
  for (std::uint32_t i = 0; i < 100; ++i) EXPECT_EQ(read.find(contact_key(i * i, i), 0), std::int32_t(i));
  EXPECT_EQ(read.find(contact_key(5, 5), 0), -1);
}

TEST(PairMemory, AKeyNearTheExpectedPlaceIsTakenThere) {
  PairMemory memory;
  for (std::uint32_t i = 0; i < 20; ++i) memory.add(contact_key(i, i + 1));
  for (std::uint32_t i = 0; i < 20; ++i)
    for (const std::size_t expected : {std::size_t(i), std::size_t(i) + 1, std::size_t(0), std::size_t(19)})
      EXPECT_EQ(memory.find(contact_key(i, i + 1), expected), std::int32_t(i));
  EXPECT_EQ(memory.find(contact_key(3, 5), 3), -1);
}

TEST(PairMemory, OfNothingNothingIsFound) {
  PairMemory memory;
  EXPECT_EQ(memory.find(contact_key(1, 2), 0), -1);
  memory.add(contact_key(1, 2));
  memory.clear();
  EXPECT_EQ(memory.find(contact_key(1, 2), 0), -1);
}

// A table made before more was added does not hide it.
TEST(PairMemory, ASearchAfterClearingSeesTheNewListAlone) {
  PairMemory memory;
  memory.add(contact_key(1, 2));
  EXPECT_EQ(memory.find(contact_key(9, 9), 100), -1);
  memory.clear();
  memory.add(contact_key(9, 9));
  EXPECT_EQ(memory.find(contact_key(9, 9), 100), 0);
  EXPECT_EQ(memory.find(contact_key(1, 2), 100), -1);
}

}  // namespace
}  // namespace lodestone
