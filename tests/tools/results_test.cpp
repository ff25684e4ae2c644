#include "tools/results.h"

#include <gtest/gtest.h>

#include <limits>

#include "reference/random.h"
#include "tests/temporary_folder.h"
#include "tools/report/report_table.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

std::string csv_of(const ordered_json& rows, const ordered_json& example) {
  const testing::TemporaryFolder folder;
  save_csv(rows, example, folder.at("table.csv"));
  return testing::bytes_of(folder.at("table.csv"));
}

TEST(Results, ACsvHasTheKeysAndALineARow) {
  const ordered_json example = {{"b", 1}, {"a", 2}, {"list", ordered_json::array()}};
  ordered_json rows = ordered_json::array();
  rows.push_back({{"b", 0.5}, {"a", nullptr}, {"list", {1, 2, 3}}});
  rows.push_back({{"b", true}, {"a", "say \"no\", twice"}, {"list", ordered_json::array()}});
  EXPECT_EQ(csv_of(rows, example), "b,a,list\n0.5,,1 2 3\ntrue,\"say \"\"no\"\", twice\",\n");
  EXPECT_EQ(csv_of(ordered_json::array(), example), "b,a,list\n");
}

TEST(Results, WhatIsNoNumberIsAnEmptyCell) {
  const ordered_json example = {{"a", 1}, {"b", 2}};
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(csv_of(ordered_json::array({{{"a", nan}, {"b", -inf}}}), example), "a,b\n,\n");
}

// What is saved is read again, whatever texts and numbers there are.
TEST(Results, WhatIsSavedIsReadAgain) {
  RandomStream random(8, 0, 0);
  const std::string letters = "ab ,\"#;'1.-e\t<µ";
  for (int round = 0; round < 40; ++round) {
    ordered_json rows = ordered_json::array();
    for (int i = 0; i < 5; ++i) {
      std::string text;
      for (int k = int(random.uniform(0, 12)); k > 0; --k)
        text += letters[std::size_t(random.uniform(0, 13))];
      ordered_json row;
      row["id"] = i + 0.0;
      row["text"] = text;
      row["number"] = std::ldexp(random.uniform(-1, 1), int(random.uniform(-60, 60)));
      row["truth"] = random.uniform() < 0.5;
      row["none"] = nullptr;
      rows.push_back(row);
    }
    const ReportTable table = parse_report_table("t", csv_of(rows, rows[0]));
    EXPECT_EQ(table.rows, rows) << rows.dump();
  }
}

TEST(Results, NothingIsNull) {
  EXPECT_TRUE(or_null(std::string()).is_null());
  EXPECT_EQ(or_null(std::string("a")), "a");
  EXPECT_TRUE(or_null(std::optional<double>()).is_null());
  EXPECT_EQ(or_null(std::optional<double>(0.0)), 0.0);
  EXPECT_TRUE(or_null(std::optional<int>()).is_null());
  EXPECT_EQ(or_null(std::optional<int>(0)), 0);
}

TEST(Results, JsonOrTextAndTheTableBesides) {
  const testing::TemporaryFolder folder;
  const ordered_json json = {{"rows", {{{"a", 1}}, {{"a", 2}}}}}, example = {{"a", 0}};
  for (const bool as_json : {false, true}) {
    ::testing::internal::CaptureStdout();
    print_table({.json = as_json, .csv = folder.at("t.csv")}, json, example, "a table\n");
    const std::string out = ::testing::internal::GetCapturedStdout();
    if (as_json)
      EXPECT_EQ(ordered_json::parse(out), json);
    else
      EXPECT_EQ(out, "a table\n");
    EXPECT_EQ(testing::bytes_of(folder.at("t.csv")), "a\n1\n2\n");
  }
}

}  // namespace
}  // namespace lodestone
