#include "reference/mesh/box_hierarchy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

namespace lodestone {
namespace {

using Box = BoxHierarchy::Box;

std::vector<Box> scattered_boxes(int count, double about) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-1.0, 1.0);
  std::vector<Box> boxes;
  for (int i = 0; i < count; ++i) {
    const Vec3 middle(about + 10.0 * place(random), 10.0 * place(random), place(random)),
        half = 0.5 * Vec3(place(random), place(random), place(random)).cwiseAbs();
    boxes.emplace_back(middle - half, middle + half);
  }
  return boxes;
}

std::vector<int> sorted(std::vector<int> numbers) {
  std::ranges::sort(numbers);
  return numbers;
}

// Of the visited those that `meets`, and all that do.
template <class Meets>
void expect_none_missing(std::vector<int> visited, const std::vector<Box>& boxes, const Meets& meets) {
  const auto misses = [&](int i) { return !meets(boxes[std::size_t(i)]); };
  std::erase_if(visited, misses);
  std::vector<int> expected;
  for (int i = 0; i < int(boxes.size()); ++i)
    if (!misses(i)) expected.push_back(i);
  EXPECT_EQ(sorted(visited), expected);
}

TEST(BoxHierarchy, FindsAllThatAreNearAndFewMore) {
  for (const double about : {0.0, 1e6}) {  // where floats are a sixteenth of a metre apart
    const std::vector<Box> boxes = scattered_boxes(1000, about);
    const BoxHierarchy tree(boxes);
    for (int i = 0; i < 50; ++i) {
      const Vec3 center = boxes[std::size_t(i)].center() + Vec3(0.3, 0.2, 0.1);
      std::vector<int> near;
      tree.visit_near(center, 0.7, [&](int number) { near.push_back(number); });
      expect_none_missing(near, boxes,
                          [&](const Box& box) { return box.squaredExteriorDistance(center) <= 0.49; });
      EXPECT_LT(near.size(), 80U);
    }
  }
}

TEST(BoxHierarchy, FindsAllThatARayMeets) {
  const std::vector<Box> boxes = scattered_boxes(1000, 0.0);
  const BoxHierarchy tree(boxes);
  const Vec3 from(-12, 0.4, 0.1), direction = Vec3(1.0, 0.05, 0.01).normalized();
  std::vector<int> met;
  tree.visit_along(from, direction, 20.0, 0.0, [&](int number) { met.push_back(number); });
  expect_none_missing(met, boxes,
                      [&](const Box& box) { return enters_box(box, 0.0, from, direction, 20.0); });
  EXPECT_LT(met.size(), 300U);
}

TEST(BoxHierarchy, HoldsNoneAndSomeWithoutEnd) {
  int visits = 0;
  BoxHierarchy(std::vector<Box>()).visit_near(Vec3::Zero(), 1e9, [&](int) { ++visits; });
  EXPECT_EQ(visits, 0);
  std::vector<Box> boxes = scattered_boxes(100, 0.0);
  const double no_end = std::numeric_limits<double>::infinity();
  boxes.emplace_back(Vec3(-no_end, -no_end, -no_end), Vec3(no_end, no_end, 0.0));
  boxes.emplace_back(Vec3(-1e300, -1, -1), Vec3(1e300, 1, 1));
  const BoxHierarchy tree(boxes);
  std::vector<int> near;
  tree.visit_near(Vec3(500, 0, 0), 1.0, [&](int number) { near.push_back(number); });
  EXPECT_TRUE(std::ranges::count(near, 100) == 1 && std::ranges::count(near, 101) == 1);
}

}  // namespace
}  // namespace lodestone
