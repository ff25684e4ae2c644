#include "reference/ode/runtime_ode.h"

#include <gtest/gtest.h>

#include <thread>

#include "reference/ode/ode_world.h"

namespace lodestone {
namespace {

class OdeRuntime : public ::testing::Test {
 protected:
  OdeRuntime() { ode::prepare(); }
};

// ODE's generator is one for the process: whoever seeds it gives it back as it was.
TEST_F(OdeRuntime, ItsRandomNumbersAreThoseOfTheSeedAndThenTheCallersAgain) {
  dRandSetSeed(12345);
  const int expected = dRandInt(1000);
  dRandSetSeed(12345);
  int first[5], again[5], other[5];
  {
    const ode::SeededRandom seeded(77);
    for (int& number : first) number = dRandInt(1 << 20);
  }
  EXPECT_EQ(dRandInt(1000), expected);
  {
    const ode::SeededRandom seeded(77);
    for (int& number : again) number = dRandInt(1 << 20);
  }
  {
    const ode::SeededRandom seeded(77 + (std::uint64_t(1) << 40));  // the high half counts, too
    for (int& number : other) number = dRandInt(1 << 20);
  }
  EXPECT_TRUE(std::equal(first, first + 5, again));
  EXPECT_FALSE(std::equal(first, first + 5, other));
}

// Messages are counted on the thread that they are raised on, kept and not printed.
TEST_F(OdeRuntime, MessagesAreCountedByThread) {
  ::testing::internal::CaptureStderr();
  const std::int64_t before = ode::messages_of_this_thread();
  dMessage(0, "the %s is %d", "answer", 42);
  EXPECT_EQ(ode::messages_of_this_thread(), before + 1);
  EXPECT_NE(last_ode_message().find("the answer is 42"), std::string_view::npos) << last_ode_message();
  std::int64_t there = -1;
  std::thread([&] {
    ode::prepare();
    dMessage(0, "elsewhere");
    there = ode::messages_of_this_thread();
  }).join();
  EXPECT_EQ(there, 1);
  EXPECT_EQ(ode::messages_of_this_thread(), before + 1);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST_F(OdeRuntime, ALongMessageIsCut) {
  const std::string text(2000, 'x');
  dMessage(0, "%s", text.c_str());
  EXPECT_LE(last_ode_message().size(), 255U);
  EXPECT_GT(last_ode_message().size(), 200U);
}

// Within a scope an error of ODE's is thrown with its words; it takes nothing down.
TEST_F(OdeRuntime, AnErrorWithinAScopeIsThrown) {
  std::string said;
  try {
    const ode::RecoverableScope scope;
    dError(1, "no %s", "way");
  } catch (const ode::AssertionFailed& failed) {
    said = failed.message;
  }
  EXPECT_NE(said.find("no way"), std::string::npos) << said;
  said.clear();
  try {
    const ode::RecoverableScope scope;
    dDebug(1, "broken");
  } catch (const ode::AssertionFailed& failed) {
    said = failed.message;
  }
  EXPECT_NE(said.find("broken"), std::string::npos) << said;
}

TEST_F(OdeRuntime, PreparedTwiceIsPreparedOnce) {
  for (int i = 0; i < 3; ++i) EXPECT_NO_THROW(ode::prepare());
  const dWorldID world = dWorldCreate();
  EXPECT_NE(world, nullptr);
  dWorldDestroy(world);
}

}  // namespace
}  // namespace lodestone
