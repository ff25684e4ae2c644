#include "tools/compare/comparison.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace lodestone {
namespace {

struct Row : MethodAtStep {
  int compared = 0, timed = 0;
};

std::vector<Method> three_methods() {
  Method ode{.name = "full", .way = OdeMethod{.substeps = 4}},
      tables{.name = "statistical", .way = StatisticalMethod{.model = StatisticalModel::tables}},
      none{.name = "low", .way = OdeMethod{}, .left_out = "has no faces"};
  return {ode, tables, none};
}

TEST(CompareMethods, ARowForEachMethodAtEachStep) {
  const ComparisonSettings settings{.dt_s = {0.01, 0.02}};
  std::vector<std::string> order;
  const std::vector<Row> rows = compare_methods<Row>(
      three_methods(), settings,
      [&](const Method& method, Row& row) {
        ++row.compared;
        order.push_back(method.name);
      },
      [&](const Method& method, Row& row) {
        EXPECT_EQ(method.name, row.method);
        ++row.timed;
        order.push_back("cost of " + method.name);
      });
  ASSERT_EQ(rows.size(), 6U);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const bool left_out = i >= 4;
    EXPECT_EQ(rows[i].method, three_methods()[i / 2].name);
    EXPECT_EQ(rows[i].dt_s, settings.dt_s[i % 2]);
    EXPECT_EQ(rows[i].compared, left_out ? 0 : 1);
    EXPECT_EQ(rows[i].timed, left_out ? 0 : 1);
    EXPECT_EQ(rows[i].reason, left_out ? "has no faces" : "");
  }
  // Times in a pass of their own, after all else.
  EXPECT_EQ(order, (std::vector<std::string>{"full", "full", "statistical", "statistical", "cost of full",
                                             "cost of full", "cost of statistical", "cost of statistical"}));
  EXPECT_EQ(rows[0].substeps, 4);
  EXPECT_EQ(rows[0].model, "");
  EXPECT_EQ(rows[2].model, "tables");
}

TEST(CompareMethods, WithoutCostsNothingIsTimed) {
  const std::vector<Row> rows = compare_methods<Row>(
      three_methods(), {.costs = false}, [](const Method&, Row&) {},
      [](const Method&, Row&) { ADD_FAILURE(); });
  EXPECT_EQ(rows.size(), 3U);
}

// Whatever the seed: no batch shares its starts with another, nor with another seed's.
TEST(ComparisonSeeds, AreOfEachBatchItsOwn) {
  std::vector<std::uint64_t> seeds;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const ComparisonSettings settings{.seed = seed};
    seeds.push_back(settings.seed_of_truth_a()), seeds.push_back(settings.seed_of_truth_b());
  }
  std::ranges::sort(seeds);
  EXPECT_EQ(std::ranges::adjacent_find(seeds), seeds.end());
}

TEST(NameOfMethod, SaysModelAndStep) {
  const std::string ode = name_of(at_step(three_methods()[0], 1.0 / 60)),
                    tables = name_of(at_step(three_methods()[1], 1.0 / 60));
  EXPECT_NE(ode.find("full"), std::string::npos);
  EXPECT_NE(tables.find("tables"), std::string::npos);
  EXPECT_NE(ode, name_of(at_step(three_methods()[0], 1.0 / 30)));
}

}  // namespace
}  // namespace lodestone
