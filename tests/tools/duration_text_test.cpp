#include "tools/duration_text.h"

#include <gtest/gtest.h>

namespace lodestone {
namespace {

TEST(DurationText, ShortTimesKeepTheirDigits) {
  EXPECT_EQ(text_of_ms(176.0), "176.00");
  EXPECT_EQ(text_of_ms(0.25), "0.25");
  EXPECT_EQ(text_of_ms(0.0021), "0.0021");
  EXPECT_EQ(text_of_ms(0.0), "0.00");
}

}  // namespace
}  // namespace lodestone
