#include "reference/ode/box_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>

#include "reference/random.h"

namespace lodestone {
namespace {

using Box = Eigen::AlignedBox3d;

// Boxes that come, go and move, and a look at each of them.
class BoxesInATree : public ::testing::Test {
 protected:
  Box draw() {
    const Vec3 low(random_.uniform(-5, 5), random_.uniform(-5, 5), random_.uniform(-5, 5));
    return {low, low + Vec3(random_.uniform(0, 2), random_.uniform(0, 2), random_.uniform(0, 2))};
  }
  void add(std::uint32_t count) {
    std::vector<BoxTree::Entry> entries;
    for (std::uint32_t i = 0; i < count; ++i) entries.push_back({next_++, draw()});
    for (const auto& [number, box] : entries) boxes_[number] = box;
    tree_.add(entries);
  }
  void expect_right() {
    for (int i = 0; i < 20; ++i) {
      const Box asked = draw();
      std::vector<std::uint32_t> found;
      tree_.find(asked, found);
      std::ranges::sort(found);
      EXPECT_EQ(std::ranges::adjacent_find(found), found.end()) << "twice";
      std::size_t meet = 0;
      for (const auto& [number, box] : boxes_) {
        if (!box.intersects(asked)) continue;
        ++meet;
        EXPECT_TRUE(std::ranges::binary_search(found, number)) << number;
      }
      for (const std::uint32_t number : found) EXPECT_TRUE(boxes_.contains(number)) << number;
      EXPECT_LE(found.size(), meet + boxes_.size() / 4);  // a few more, not all
    }
  }

  BoxTree tree_;
  std::map<std::uint32_t, Box> boxes_;
  std::uint32_t next_ = 0;
  RandomStream random_{13, 0, 0};
};

TEST_F(BoxesInATree, AreFoundWhereTheyAre) {
  for (const std::uint32_t count : {1u, 3u, 200u, 2u}) {
    add(count);
    expect_right();
  }
}

TEST_F(BoxesInATree, AreFoundWhereTheyWent) {
  add(150);
  for (int step = 0; step < 60; ++step) {
    for (auto& [number, box] : boxes_) {
      if (number % 3 != 0) continue;
      // Some creep, some leap, some grow.
      const Box before = box;
      box.translate((number % 2 ? 0.01 : 1.0) * random_.direction());
      if (number % 5 == 0) box.extend(Vec3(box.max() + Vec3(0.1, 0.1, 0.1)));
      tree_.move(number, before, box);
    }
    if (step % 10 == 0) expect_right();
  }
}

TEST_F(BoxesInATree, AreGoneOnceRemoved) {
  add(100);
  for (std::uint32_t number = 0; number < 100; number += 2) {
    tree_.remove(number);
    boxes_.erase(number);
  }
  expect_right();
  add(50);
  expect_right();
  for (const auto& [number, box] : boxes_) tree_.remove(number);
  boxes_.clear();
  expect_right();
}

// One that is no number is kept, as it may be one again, and hides no other.
TEST_F(BoxesInATree, OneThatIsNotFiniteHidesNobody) {
  add(50);
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinity = std::numeric_limits<double>::infinity();
  const Box bad[] = {{Vec3(nan, 0, 0), Vec3(1, 1, 1)}, {Vec3(0, 0, 0), Vec3(infinity, 1, 1)}};
  for (std::uint32_t i = 0; i < 2; ++i) {
    const BoxTree::Entry entry{1000 + i, bad[i]};
    tree_.add({&entry, 1});
  }
  for (const auto& [number, box] : boxes_) {
    std::vector<std::uint32_t> found;
    tree_.find(box, found);
    EXPECT_NE(std::ranges::find(found, number), found.end()) << number;
  }
  const Box now = draw();
  tree_.move(1000, bad[0], now);
  std::vector<std::uint32_t> found;
  tree_.find(now, found);
  EXPECT_NE(std::ranges::find(found, 1000u), found.end());
  tree_.remove(1000), tree_.remove(1001);
  expect_right();
}

}  // namespace
}  // namespace lodestone
