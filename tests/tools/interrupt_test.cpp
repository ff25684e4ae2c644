// Signals are for the whole process: each test is one of its own.
#include "tools/interrupt.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>

namespace lodestone {
namespace {

/// How a child ends that does this: its exit code, or 1000 and the signal that killed it.
int end_of(const std::function<int()>& act) {
  const pid_t child = ::fork();
  if (child == 0) {
    for (const int signal : {SIGINT, SIGTERM}) ::signal(signal, SIG_DFL);  // whatever the other tests did
    ::_exit(act());
  }
  int status = 0;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
}

bool throws() {
  try {
    throw_if_interrupted();
  } catch (const Interrupted&) {
    return true;
  }
  return false;
}

TEST(Interrupt, TheFirstSignalIsNotedForWhoAsks) {
  for (const auto& [signal, code] :
       {std::pair(SIGINT, ExitCode::interrupted), {SIGTERM, ExitCode::terminated}})
    EXPECT_EQ(end_of([signal = signal, code = code] {
                catch_interrupts();
                const bool before = is_interrupted() || throws();
                ::raise(signal);
                return !before && interrupting_signal() == signal && throws() &&
                               interrupted_exit_code() == code
                           ? 7
                           : 1;
              }),
              7);
}

TEST(Interrupt, TheSecondEndsTheProcess) {
  EXPECT_EQ(end_of([] {
              catch_interrupts();
              ::raise(SIGINT);
              ::raise(SIGTERM);
              return 7;
            }),
            128 + SIGTERM);
}

TEST(Interrupt, OneThatWasIgnoredStaysSo) {
  EXPECT_EQ(end_of([] {
              ::signal(SIGINT, SIG_IGN);
              catch_interrupts();
              ::raise(SIGINT);
              ::raise(SIGINT);
              return is_interrupted() ? 1 : 7;
            }),
            7);
}

TEST(Interrupt, WithoutCatchingItEndsAtOnce) {
  EXPECT_EQ(end_of([] {
              ::raise(SIGTERM);
              return 7;
            }),
            1000 + SIGTERM);
}

TEST(Interrupt, PartsThatAreWholeStay) {
  EXPECT_EQ(end_of([] {
              catch_interrupts();
              int parts = 0;
              until_interrupted([&] {
                for (; parts < 10; ++parts) {
                  if (parts == 3) ::raise(SIGINT);
                  throw_if_interrupted();
                }
              });
              return parts;
            }),
            3);
}

}  // namespace
}  // namespace lodestone
