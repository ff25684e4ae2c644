#include "tools/terminal.h"

#include <gtest/gtest.h>

namespace lodestone {
namespace {

TEST(Terminal, StylesAreForTerminalsOnly) {
  EXPECT_EQ(styled("FAILED", Style::bad, true), "\x1b[1;31mFAILED\x1b[0m");
  EXPECT_EQ(styled("FAILED", Style::bad, false), "FAILED");
}

}  // namespace
}  // namespace lodestone
