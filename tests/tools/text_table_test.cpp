#include "tools/text_table.h"

#include <gtest/gtest.h>

namespace lodestone {
namespace {

TEST(TextTable, AlignsNumbersRightAndTextLeft) {
  TextTable table({"name", "value"});
  table.add_row({"a", "1.5"});
  table.add_row({"long name", "100.25"});
  EXPECT_EQ(table.text(),
            "name        value\n"
            "-----------------\n"
            "a             1.5\n"
            "long name  100.25\n");
}

TEST(TextTable, ShortRowsEndEarly) {
  TextTable table({"a", "b", "c"});
  table.add_row({"x"});
  table.add_row({"y", "2", "-"});
  EXPECT_EQ(table.text(),
            "a  b  c\n"
            "-------\n"
            "x\n"
            "y  2  -\n");
}

TEST(DurationText, ShortTimesKeepTheirDigits) {
  EXPECT_EQ(text_of_ms(176.0), "176.00");
  EXPECT_EQ(text_of_ms(0.25), "0.25");
  EXPECT_EQ(text_of_ms(0.0021), "0.0021");
  EXPECT_EQ(text_of_ms(0.0), "0.00");
}

}  // namespace
}  // namespace lodestone
