#include "tools/compare/series_parts.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "reference/error.h"
#include "tests/message_of.h"
#include "tests/tools/methods/box_job.h"
#include "tools/compare/drop_series.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

ordered_json row(int number, double restitution, double friction, double score) {
  return {{"materials", "by name"}, {"case", number},          {"restitution", restitution},
          {"friction", friction},   {"method", "statistical"}, {"model", "support"},
          {"dt_s", 1.0 / 60},       {"score", score},          {"floor", 0.05}};
}

ordered_json part(const char* shard, std::vector<ordered_json> rows) {
  return {{"trials", 12},
          {"rows", std::move(rows)},
          {"series", {{"of", "materials"}, {"seed", 1}}},
          {"shard", shard}};
}

std::vector<ordered_json> two_parts() {
  return {part("2/2", {row(1, 0.0, 0.5, 0.2)}), part("1/2", {row(0, 0.0, 0.0, 0.1), row(2, 0.9, 0.0, 0.3)})};
}

ordered_json merge(const std::vector<ordered_json>& parts) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < parts.size(); ++i) names.push_back("part_" + std::to_string(i) + ".json");
  return merge_series(parts, names);
}

std::string fault_of(const std::vector<ordered_json>& parts) {
  return testing::message_of([&] { merge(parts); });
}

TEST(SeriesParts, AreJoinedInTheOrderOfTheirCases) {
  const ordered_json merged = merge(two_parts());
  ASSERT_EQ(merged["rows"].size(), 3U);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(merged["rows"][std::size_t(i)]["case"], i);
  EXPECT_EQ(merged["trials"], 12);
  EXPECT_FALSE(merged.contains("shard"));
}

TEST(SeriesParts, ACaseThatEachPartHasIsThereOnce) {
  std::vector<ordered_json> parts = two_parts();
  parts[0]["rows"].insert(parts[0]["rows"].begin(), row(0, 0.0, 0.0, 0.1));
  EXPECT_EQ(merge(parts)["rows"].size(), 3U);
}

TEST(SeriesParts, WhatDoesNotFitIsRefusedAndNamed) {
  std::vector<ordered_json> parts = two_parts();
  parts.pop_back();
  EXPECT_NE(fault_of(parts).find("found no part 1/2"), std::string::npos);
  parts = two_parts();
  parts[1] = parts[0];
  EXPECT_EQ(fault_of(parts), "part_1.json: found part 2/2 twice, expected each once");
  parts = two_parts();
  parts[1]["trials"] = 13;
  EXPECT_NE(fault_of(parts).find("13"), std::string::npos);
  parts = two_parts();
  parts[1]["shard"] = "1/3";
  EXPECT_NE(fault_of(parts).find("1/3"), std::string::npos);
  parts = two_parts();
  parts[0]["incomplete"] = true;
  EXPECT_NE(fault_of(parts).find("incomplete"), std::string::npos);
  parts = two_parts();
  parts[1]["series"]["seed"] = 2;
  EXPECT_NE(fault_of(parts).find("\"seed\":2"), std::string::npos);
  parts = two_parts();
  parts[0]["rows"] = ordered_json::array();  // a share may be of no case
  parts[0]["series"]["of"] = "shapes";
  EXPECT_NE(fault_of(parts).find("shapes"), std::string::npos);
  EXPECT_NE(fault_of({ordered_json::object()}), "");
  EXPECT_NE(fault_of({}), "");
}

TEST(SeriesParts, RowsWithoutTheNumberOfTheirCaseAreRefused) {
  for (const ordered_json& bad :
       {ordered_json(7), ordered_json("row"), ordered_json::array(), ordered_json::object(),
        ordered_json{{"case", "1"}}, ordered_json{{"case", 0.5}}}) {
    std::vector<ordered_json> parts = two_parts();
    parts[1]["rows"].push_back(bad);
    EXPECT_NE(fault_of(parts).find(bad.dump()), std::string::npos) << bad;
  }
  std::vector<ordered_json> parts = two_parts();
  parts[0]["rows"] = "none";
  EXPECT_NE(fault_of(parts).find("no part of a comparison"), std::string::npos);
}

TEST(SeriesParts, MaterialsWithoutTheirNumbersAreRefused) {
  std::vector<ordered_json> parts = two_parts();
  parts[1]["rows"].push_back({{"case", 3}, {"materials", "x"}});
  EXPECT_TRUE(fault_of(parts).starts_with("part_1.json: found the row {\"case\":3,")) << fault_of(parts);
}

TEST(SeriesParts, AShareWithoutACaseIsAPart) {
  std::vector<ordered_json> parts = two_parts();
  parts[0]["rows"] = ordered_json::array();
  EXPECT_EQ(merge(parts)["rows"].size(), 2U);
}

TEST(SeriesParts, MaterialsMakeATableOfAMethod) {
  const std::string text = material_tables_of(merge(two_parts()));
  EXPECT_NE(text.find("statistical support"), std::string::npos);
  EXPECT_NE(text.find("friction 0.5"), std::string::npos);
  EXPECT_NE(text.find("0.300 (0.050)"), std::string::npos);
}

TEST(MaterialCases, AreEveryPairOnceAndSharedOut) {
  const std::vector<DropCase> all = make_material_cases(testing::box_job());
  EXPECT_EQ(all.size(), 30U);
  std::size_t shared = 0;
  for (int i = 0; i < 4; ++i) {
    std::vector<DropCase> some = all;
    keep_share(some, {i, 4}, false);
    for (const DropCase& one : some) EXPECT_EQ(one.index % 4, i);
    shared += some.size();
  }
  EXPECT_EQ(shared, all.size());
  std::vector<DropCase> with_first = all;
  keep_share(with_first, {1, 4}, true);
  EXPECT_EQ(with_first[0].index, 0);
  EXPECT_EQ(with_first[1].index, 1);
}

}  // namespace
}  // namespace lodestone
