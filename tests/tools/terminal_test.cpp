#include "tools/terminal.h"

#include <gtest/gtest.h>

namespace lodestone {
namespace {

TEST(Terminal, StylesAreForTerminalsOnly) {
  EXPECT_EQ(styled("FAILED", Style::bad, true), "\x1b[1;31mFAILED\x1b[0m");
  EXPECT_EQ(styled("FAILED", Style::bad, false), "FAILED");
}

TEST(Printable, LeavesTextAsItIs) {
  EXPECT_EQ(printable("bunny.obj: found 3, expected 4"), "bunny.obj: found 3, expected 4");
  EXPECT_EQ(printable("größe – \xe2\x82\xac \xf0\x9f\x90\xb0"), "größe – \xe2\x82\xac \xf0\x9f\x90\xb0");
  EXPECT_EQ(printable(""), "");
}

TEST(Printable, NothingThatATerminalObeys) {
  EXPECT_EQ(printable("a\x1b[31mred"), "a\\x1b[31mred");
  EXPECT_EQ(printable("two\nlines\t\r"), "two\\nlines\\t\\r");
  EXPECT_EQ(printable(std::string_view("\0\x7f", 2)), "\\x00\\x7f");
  EXPECT_EQ(printable("\xc2\x9b"
                      "31m"),
            "\\xc2\\x9b"
            "31m");  // U+009B begins a sequence, too
}

TEST(Printable, WhatIsNoTextIsShownByteByByte) {
  EXPECT_EQ(printable("\xff\xfe"), "\\xff\\xfe");
  EXPECT_EQ(printable("\xe2\x82"), "\\xe2\\x82");                    // cut short
  EXPECT_EQ(printable("\xc0\x9b"), "\\xc0\\x9b");                    // overlong
  EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80");           // a surrogate
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");  // beyond U+10FFFF
}

TEST(Printable, LongTextsLoseTheirMiddle) {
  const std::string shown = printable("begin" + std::string(5000, 'x') + "end");
  EXPECT_LT(shown.size(), 900U);
  EXPECT_TRUE(shown.starts_with("beginxxx"));
  EXPECT_TRUE(shown.ends_with("xxxend"));
  EXPECT_NE(shown.find(" ... (4208 bytes) ... "), shown.npos) << shown;
}

}  // namespace
}  // namespace lodestone
