// With LODESTONE_TRAP_FLOATING_POINT set (tools/test --sanitize), a division by zero, an overflow or an
// invalid operation in a test ends it with SIGFPE: a NaN is then found where it comes from, not where it
// shows. Tests that mean to make one, or whose libraries do, are left out there.
#include <gtest/gtest.h>

#include <cfenv>
#include <csignal>
#include <cstdlib>

namespace lodestone {
namespace {

void trap() { feenableexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW); }

class Traps : public ::testing::EmptyTestEventListener {
  void OnTestStart(const ::testing::TestInfo&) override { trap(); }
  void OnTestEnd(const ::testing::TestInfo&) override {
    fedisableexcept(FE_ALL_EXCEPT);
    std::feclearexcept(FE_ALL_EXCEPT);
  }
};

// Added before main, as gtest_main's is the only main.
const bool kTrapping = [] {
  if (!std::getenv("LODESTONE_TRAP_FLOATING_POINT")) return false;
  ::testing::UnitTest::GetInstance()->listeners().Append(new Traps);  // which owns it
  return true;
}();

TEST(FloatingPointTraps, EndWhatDividesByZero) {
  const auto divide = [] {
    trap();
    volatile double zero = 0.0;
    const volatile double infinite = 1.0 / zero;
    std::exit(infinite > 0.0 ? 0 : 1);
  };
  EXPECT_EXIT(divide(), ::testing::KilledBySignal(SIGFPE), "");
}

TEST(FloatingPointTraps, AreSetWhereAskedFor) { EXPECT_EQ(fegetexcept() != 0, kTrapping); }

}  // namespace
}  // namespace lodestone
