// With LODESTONE_TRAP_FLOATING_POINT set (tools/test --sanitize), a division by zero, an overflow or an
// invalid operation in a test ends it with SIGFPE: a NaN is then found where it comes from, not where it
// shows. Tests that mean to make one are left out there; libccd, which divides by the length of edges that
// have none and drops what comes of it, is called without traps.
#include <ccd/ccd.h>
#include <gtest/gtest.h>

#include <cfenv>
#include <csignal>
#include <cstdlib>

namespace lodestone {
namespace {

/// No exception ends the program while it lives, nor what was raised meanwhile afterwards.
class WithoutTraps {
 public:
  WithoutTraps() { std::feholdexcept(&before_); }
  ~WithoutTraps() { std::fesetenv(&before_); }
  WithoutTraps(const WithoutTraps&) = delete;
  WithoutTraps& operator=(const WithoutTraps&) = delete;

 private:
  std::fenv_t before_{};
};

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

// The linker's --wrap (CMakeLists.txt) has every call of ours go through these.
extern "C" {
int __real_ccdMPRPenetration(const void*, const void*, const ccd_t*, ccd_real_t*, ccd_vec3_t*, ccd_vec3_t*);
int __real_ccdGJKPenetration(const void*, const void*, const ccd_t*, ccd_real_t*, ccd_vec3_t*, ccd_vec3_t*);

int __wrap_ccdMPRPenetration(const void* a, const void* b, const ccd_t* query, ccd_real_t* depth,
                             ccd_vec3_t* direction, ccd_vec3_t* position) {
  const lodestone::WithoutTraps untrapped;
  return __real_ccdMPRPenetration(a, b, query, depth, direction, position);
}

int __wrap_ccdGJKPenetration(const void* a, const void* b, const ccd_t* query, ccd_real_t* depth,
                             ccd_vec3_t* direction, ccd_vec3_t* position) {
  const lodestone::WithoutTraps untrapped;
  return __real_ccdGJKPenetration(a, b, query, depth, direction, position);
}
}
