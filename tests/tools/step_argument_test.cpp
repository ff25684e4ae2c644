#include "tools/step_argument.h"

#include <gtest/gtest.h>

namespace lodestone {
namespace {

TEST(StepArgument, DecimalsAndFractions) {
  EXPECT_EQ(find_step_fault("0.01"), "");
  EXPECT_EQ(find_step_fault("1/60"), "");
  EXPECT_DOUBLE_EQ(step_of("1/60"), 1.0 / 60.0);
  EXPECT_EQ(steps_of({"1/240", "0.005"}), (std::vector<double>{1.0 / 240.0, 0.005}));
}

TEST(StepArgument, FaultsNameWhatWasFound) {
  for (const char* text :
       {"", "0", "-0.01", "0.2", "1/0", "1/", "/60", "1/60s", "nan", "inf", "1/nan", "a"}) {
    const std::string fault = find_step_fault(text);
    EXPECT_NE(fault.find(std::string("'") + text + "'"), std::string::npos) << text << ": " << fault;
  }
}

}  // namespace
}  // namespace lodestone
