#include "tools/compare/wasserstein.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "reference/random.h"

namespace lodestone {
namespace {

std::vector<double> uniform_values(std::size_t count, std::uint64_t seed) {
  RandomStream random(seed, 0, 0);
  std::vector<double> values(count);
  std::ranges::generate(values, [&] { return random.uniform(); });
  return values;
}

// The definition for equal sizes: the k-th smallest of one against the k-th smallest of the other.
double sorted_mean_difference(std::vector<double> a, std::vector<double> b) {
  std::ranges::sort(a);
  std::ranges::sort(b);
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(a[i] - b[i]);
  return sum / double(a.size());
}

std::vector<double> repeated(const std::vector<double>& values, int times) {
  std::vector<double> all;
  for (int i = 0; i < times; ++i) all.insert(all.end(), values.begin(), values.end());
  return all;
}

TEST(Wasserstein, OfASampleWithItselfIsZero) {
  const std::vector<double> a = uniform_values(50, 1);
  EXPECT_EQ(wasserstein_distance(a, a), 0.0);
}

TEST(Wasserstein, OfAShiftedSampleIsTheShift) {
  std::vector<double> a = uniform_values(100, 1), b = a;
  for (double& value : b) value += 3.25;
  EXPECT_NEAR(wasserstein_distance(a, b), 3.25, 1e-12);
  EXPECT_NEAR(wasserstein_distance(b, a), 3.25, 1e-12);
}

TEST(Wasserstein, EqualSizesAgreeWithSortedDifferences) {
  const std::vector<double> a = uniform_values(200, 1), b = uniform_values(200, 2);
  EXPECT_NEAR(wasserstein_distance(a, b), sorted_mean_difference(a, b), 1e-12);
}

// Both samples repeated to a common size are the same two distributions.
TEST(Wasserstein, UnequalSizesAreExact) {
  const std::vector<double> a = uniform_values(30, 1), b = uniform_values(70, 2);
  EXPECT_NEAR(wasserstein_distance(a, b), sorted_mean_difference(repeated(a, 7), repeated(b, 3)), 1e-12);
  EXPECT_DOUBLE_EQ(wasserstein_distance(std::vector{0.0}, std::vector{1.0, 2.0, 6.0}), 3.0);
}

TEST(Wasserstein, CountsActAsRepetition) {
  const std::vector<double> a = {0.0, 1.0, 5.0}, b = {2.0, 3.0};
  const std::vector<std::uint32_t> a_counts = {2, 0, 1}, b_counts = {1, 3};
  EXPECT_NEAR(SamplePair(a, b).wasserstein(a_counts, b_counts),
              wasserstein_distance(std::vector{0.0, 0.0, 5.0}, std::vector{2.0, 3.0, 3.0, 3.0}), 1e-12);
}

}  // namespace
}  // namespace lodestone
