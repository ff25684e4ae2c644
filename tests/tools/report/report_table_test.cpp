#include "tools/report/report_table.h"

#include <gtest/gtest.h>

#include "tests/message_of.h"

namespace lodestone {
namespace {

TEST(ReportTables, CommentsAreHowItWasMade) {
  const ReportTable table = parse_report_table(
      "t",
      "# command: a --b\n# command: c\n# commit: 12ab\n# machine: two cores\n# date: 2026-01-02\n"
      "# anything else\nx,y\n1,2\n");
  EXPECT_EQ(table.made.commands, (std::vector<std::string>{"a --b", "c"}));
  EXPECT_EQ(table.made.commit, "12ab");
  EXPECT_EQ(table.made.machine, "two cores");
  EXPECT_EQ(table.made.date, "2026-01-02");
  EXPECT_FALSE(table.made.fresh);
  const auto json = json_of(table.made);
  EXPECT_EQ(json["commands"].size(), 2U);
  EXPECT_EQ(json["commit"], "12ab");
}

TEST(ReportTables, CellsAreWhatTheyReadAs) {
  const ReportTable table = parse_report_table("t", "a,b,c,d,e,f,g,h\n1,-2.5e3,,true,false,text,\"1\",1e\n");
  ASSERT_EQ(table.rows.size(), 1U);
  const auto& row = table.rows[0];
  EXPECT_EQ(row["a"], 1.0);
  EXPECT_EQ(row["b"], -2500.0);
  EXPECT_TRUE(row["c"].is_null());
  EXPECT_EQ(row["d"], true);
  EXPECT_EQ(row["e"], false);
  EXPECT_EQ(row["f"], "text");
  EXPECT_EQ(row["g"], "1");  // in quotes it is text
  EXPECT_EQ(row["h"], "1e");
}

TEST(ReportTables, LinesMayEndAsOnOtherSystems) {
  const ReportTable table = parse_report_table("t", "# commit: 1\r\na,b\r\n1,\"x,\"\"y\"\r\n3,4");
  EXPECT_EQ(table.made.commit, "1");
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_EQ(table.rows[0]["b"], "x,\"y");
  EXPECT_EQ(table.rows[1]["b"], 4.0);
}

TEST(ReportTables, ARowOfAnotherLengthIsSaid) {
  EXPECT_EQ(testing::message_of([] { parse_report_table("t.csv", "a,b\n1,2\n1\n"); }),
            "t.csv: line 3: found 1 cells, expected 2");
  EXPECT_EQ(testing::message_of([] { parse_report_table("t.csv", "# commit: x\na,b\n1,2,3\n"); }),
            "t.csv: line 3: found 3 cells, expected 2");
}

TEST(ReportTables, BaselinesAreInTheProgram) {
  EXPECT_FALSE(load_baseline("hashes.csv").rows.empty());
  EXPECT_THROW(load_baseline("none.csv"), std::logic_error);
}

}  // namespace
}  // namespace lodestone
