#include "lod/rungs/near_marks.h"

#include <gtest/gtest.h>

#include <set>

#include "reference/random.h"

namespace lodestone {
namespace {

// Step by step, against a plain set; full bodies and the ground have no marks.
TEST(NearMarks, AreThoseOfThisStep) {
  RandomStream random(3, 0, 0);
  NearMarks marks;
  for (int step = 0; step < 30; ++step) {
    const auto bodies = std::size_t(5 + step % 7 * 10);
    marks.begin(bodies);
    std::set<std::size_t> expected;
    for (int i = 0; i < 20; ++i) {
      const auto index = std::size_t(random.uniform(0, double(bodies)));
      if (i % 4 == 0) {
        marks.mark(Participant::full(index));
        marks.mark(Participant::ground());
        continue;
      }
      marks.mark(Participant::statistical(index));
      expected.insert(index);
    }
    for (std::size_t i = 0; i < bodies; ++i) EXPECT_EQ(marks[i], expected.contains(i)) << step;
  }
}

// Planned or not, it is near; the next step begins without.
TEST(NearMarks, KnowThePaceOfEachAndOneOfAllFullBodies) {
  NearMarks marks;
  marks.begin(3);
  const Participant slow = Participant::statistical(0), quick = Participant::statistical(2);
  marks.mark(slow);
  EXPECT_EQ(marks.pace(slow), NearMarks::kUnplanned);
  marks.set_pace(slow, 3), marks.set_pace(quick, 12), marks.set_full_pace(5);
  marks.mark(quick);
  EXPECT_EQ(marks.pace(slow), 3);
  EXPECT_EQ(marks.pace(quick), 12);
  EXPECT_EQ(marks.pace(Participant::statistical(1)), 0);
  EXPECT_EQ(marks.pace(Participant::full(7)), 5);
  EXPECT_EQ(marks.marked().size(), 2u);
  marks.begin(3);
  for (const Participant p : {slow, quick, Participant::full(7)}) EXPECT_EQ(marks.pace(p), 0);
}

TEST(Participant, KnowsItsKindAndIndex) {
  for (const std::size_t index : {std::size_t(0), std::size_t(7), (std::size_t(1) << 30) - 1}) {
    EXPECT_TRUE(Participant::statistical(index).is_statistical());
    EXPECT_TRUE(Participant::full(index).is_full());
    EXPECT_EQ(Participant::statistical(index).index(), index);
    EXPECT_EQ(Participant::full(index).index(), index);
    EXPECT_FALSE(Participant::full(index) == Participant::statistical(index));
  }
  EXPECT_TRUE(Participant::ground().is_ground());
}

}  // namespace
}  // namespace lodestone
