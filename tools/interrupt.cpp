#include "tools/interrupt.h"

#include <unistd.h>

#include <atomic>
#include <csignal>

namespace lodestone {
namespace {

// Lock-free, so that a handler may write it and any thread read it.
std::atomic<int> noted_signal = 0;
static_assert(std::atomic<int>::is_always_lock_free);

extern "C" void note_signal(int signal) {
  if (noted_signal.exchange(signal) != 0) ::_exit(128 + signal);
}

}  // namespace

void catch_interrupts() {
  for (const int signal : {SIGINT, SIGTERM}) {
    struct sigaction before {
    }, action{};
    ::sigaction(signal, nullptr, &before);
    if (before.sa_handler == SIG_IGN) continue;
    action.sa_handler = note_signal;
    action.sa_flags = SA_RESTART;  // reads and writes under way go on
    ::sigemptyset(&action.sa_mask);
    ::sigaction(signal, &action, nullptr);
  }
}

int interrupting_signal() { return noted_signal; }

ExitCode interrupted_exit_code() {
  return interrupting_signal() == SIGTERM ? ExitCode::terminated : ExitCode::interrupted;
}

const char* Interrupted::what() const noexcept {
  return interrupting_signal() == SIGTERM ? "ended by SIGTERM" : "interrupted by SIGINT";
}

void throw_if_interrupted() {
  if (is_interrupted()) throw Interrupted();
}

}  // namespace lodestone
