#include "lod/manager/rung_set.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace lodestone {
namespace {

constexpr Rung kTables = Rung::tables, kSupport = Rung::support, kFull = Rung::full;

// All seven that are not empty, and what is in them.
struct KnownSet {
  RungSet set;
  std::vector<Rung> rungs;
};
std::vector<KnownSet> every_set() {
  return {{{kTables}, {kTables}},
          {{kSupport}, {kSupport}},
          {{kFull}, {kFull}},
          {{kTables, kSupport}, {kTables, kSupport}},
          {{kFull, kTables}, {kTables, kFull}},
          {{kSupport, kFull}, {kSupport, kFull}},
          {kEveryRung, {kTables, kSupport, kFull}}};
}

TEST(RungSet, HasWhatItWasGivenFromLowestToHighest) {
  for (const auto& [set, rungs] : every_set()) {
    for (const Rung rung : {kTables, kSupport, kFull})
      EXPECT_EQ(set.has(rung), std::ranges::count(rungs, rung) == 1);
    EXPECT_EQ(set.one(), rungs.size() == 1);
    EXPECT_EQ(set.lowest(), rungs.front());
    EXPECT_EQ(set.highest(), rungs.back());
  }
}

TEST(RungSet, TheHighestThatIsNoHigher) {
  for (const auto& [set, rungs] : every_set())
    for (const Rung limit : {kTables, kSupport, kFull}) {
      Rung expected = rungs.front();  // where none is as low
      for (const Rung rung : rungs)
        if (rung <= limit) expected = rung;
      EXPECT_EQ(set.at_most(limit), expected);
    }
}

TEST(RungSet, WithinAnotherItIsNeverEmpty) {
  EXPECT_EQ((RungSet{kTables, kSupport}.within({kSupport, kFull})), RungSet{kSupport});
  EXPECT_EQ(RungSet{kTables}.within({kSupport, kFull}), (RungSet{kSupport, kFull}));
  EXPECT_EQ(kEveryRung.within({kFull}), RungSet{kFull});
}

TEST(RungSet, OfTwoWithNothingInCommonTheHigherPrevails) {
  EXPECT_EQ((RungSet{kTables, kSupport}.together_with({kSupport, kFull})), RungSet{kSupport});
  for (const auto& [one, other] : {std::pair{RungSet{kFull}, RungSet{kTables}},
                                   {RungSet{kFull}, RungSet{kTables, kSupport}},
                                   {RungSet{kSupport, kFull}, RungSet{kTables}}}) {
    EXPECT_EQ(one.together_with(other), one);
    EXPECT_EQ(other.together_with(one), one);
  }
}

TEST(RungSet, WhatTablesCannotHoldIsAtSupport) {
  EXPECT_EQ(RungSet{kTables}.with_support_for_tables(), RungSet{kSupport});
  EXPECT_EQ((RungSet{kTables, kFull}.with_support_for_tables()), (RungSet{kSupport, kFull}));
  EXPECT_EQ(RungSet{kFull}.with_support_for_tables(), RungSet{kFull});
}

TEST(RungSet, BetweenTwoAreBothAndWhatLiesThere) {
  EXPECT_EQ(RungSet::between(kTables, kFull), kEveryRung);
  EXPECT_EQ(RungSet::between(kSupport, kFull), (RungSet{kSupport, kFull}));
  EXPECT_EQ(RungSet::between(kSupport, kSupport), RungSet{kSupport});
}

}  // namespace
}  // namespace lodestone
